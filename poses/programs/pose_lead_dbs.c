/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads reco.SPACE.coords_mm: a cell for each lead with the positions of its contacts, the lowest first. */
#include "poses/programs/pose_programs.h"

#include "base/formats/matlab.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>

/* In the order of preference; the first is of the template. */
static const char *const names[] = {"mni", "scrf", "native"};

enum { SPACES = sizeof names / sizeof names[0] };

/* Older files have coords_mm as a variable, in MNI space. */
static const struct matlab_array *find_coordinates(const struct matlab *matlab, size_t space)
{
    const struct matlab_array *reco = matlab_variable(matlab, "reco");
    const struct matlab_array *in_space = matlab_field(matlab, reco, 0, names[space]);
    return !reco && space == 0 ? matlab_variable(matlab, "coords_mm") : matlab_field(matlab, in_space, 0, "coords_mm");
}

static conus_status add_lead(conus_pose_list *list, const struct matlab_array *array, size_t lead)
{
    if (!array->count) {
        return CONUS_OK; /* a side without a lead */
    }
    if (!matlab_is_real(array) || array->columns != 3 || array->count != 3 * array->rows) {
        return fail(CONUS_ERROR_DATA, "coords_mm{%zu}: %s with %zu x %zu, contacts x 3 numbers are needed", lead + 1,
                    matlab_class_name(array).text, array->rows, array->columns);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < array->rows; i++) {
        char name[64];
        double point[3];
        for (size_t k = 0; k < 3; k++) {
            point[k] = matlab_number(array, k * array->rows + i);
        }
        /* Lead 1 is the right one, lead 2 the left one. */
        int size = lead < 2 ? snprintf(name, sizeof name, "%c%zu", "RL"[lead], i + 1)
                            : snprintf(name, sizeof name, "lead%zu-%zu", lead + 1, i + 1);
        const struct text id = {name, (size_t)size};
        status = pose_list_add_point(list, list->count + 1, point, false, id, CONUS_OK);
    }
    return status;
}

static conus_status add_leads(conus_pose_list *list, const struct matlab *matlab, const struct matlab_array *cells)
{
    if (cells->kind != MATLAB_CELL && cells->count) {
        return fail(CONUS_ERROR_DATA, "coords_mm: %s, a cell array with a cell for each lead is needed",
                    matlab_class_name(cells).text);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < cells->count; i++) {
        status = add_lead(list, &matlab->arrays[cells->parts + i], i);
    }
    return status;
}

static conus_status note_space(conus_pose_list *list, size_t space)
{
    if (space == 0) {
        list->space = pose_space_named(text_from("MNI152NLin2009bAsym"), POSE_BRAIN_MNI152);
        return notes_add(&list->notes,
                         "contacts are those in MNI space, reco.mni; the format lead-dbs-native takes the "
                         "patient's own");
    }
    char name[64];
    snprintf(name, sizeof name, "Lead-DBS %s", names[space]);
    list->space = pose_space_named(text_from(name), POSE_BRAIN_SUBJECT);
    return notes_add(&list->notes, "contacts are those in the patient's own space, reco.%s", names[space]);
}

/* The first space from @p *space on that there is. */
static conus_status find_space(const struct matlab_array **found, size_t *space, const struct matlab *matlab)
{
    bool native = *space > 0;
    *found = find_coordinates(matlab, *space);
    while (!*found && *space + 1 < SPACES) {
        *found = find_coordinates(matlab, ++*space);
    }
    const struct matlab_array *reco = matlab_variable(matlab, "reco");
    if (!*found && reco && reco->kind != MATLAB_STRUCT) {
        return fail(CONUS_ERROR_DATA, "reco: %s, a structure is needed", matlab_class_name(reco).text);
    }
    return *found ? CONUS_OK
                  : fail(CONUS_ERROR_DATA, "no positions of contacts, reco.%s.coords_mm: no reconstruction of Lead-DBS",
                         names[native ? SPACES - 1 : 0]);
}

static conus_status add_contacts(conus_pose_list *list, const struct matlab *matlab, const conus_pose_options *options,
                                 size_t space)
{
    const struct matlab_array *found = NULL;
    conus_status status = pose_no_axis(options, "contacts");
    status = status ? status : find_space(&found, &space, matlab);
    status = status ? status : note_space(list, space);
    status = status ? status : pose_note_space(&list->notes, options, false);
    return status ? status : add_leads(list, matlab, found);
}

static conus_status parse_from(conus_pose_list *list, struct text text, const conus_pose_options *options, size_t space)
{
    struct matlab matlab = {0};
    conus_status status = matlab_is(text)
                              ? matlab_parse(&matlab, text, pose_memory(options) - text.size)
                              : fail(CONUS_ERROR_DATA, "not a file of MATLAB: no reconstruction of Lead-DBS");
    status = status ? status : add_contacts(list, &matlab, options, space);
    matlab_finish(&matlab);
    return status;
}

conus_status pose_lead_dbs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    return parse_from(list, text, options, 0);
}

conus_status pose_lead_dbs_parse_native(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    return parse_from(list, text, options, 1);
}

conus_status pose_lead_dbs_find(bool *found, conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct matlab matlab = {0};
    conus_status status = matlab_parse(&matlab, text, pose_memory(options) - text.size);
    *found = !status && (matlab_variable(&matlab, "reco") || matlab_variable(&matlab, "coords_mm"));
    status = *found ? add_contacts(list, &matlab, options, 0) : status;
    matlab_finish(&matlab);
    return status;
}
