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

static void add_lead(const struct pose_reading *to, const struct matlab_array *array, size_t lead)
{
    if (array->count && (!matlab_is_real(array) || array->columns != 3 || array->count != 3 * array->rows)) {
        job_bad(to->job, "coords_mm{%zu}: %s with %zu x %zu, contacts x 3 numbers are needed", lead + 1,
                matlab_class_name(array).text, array->rows, array->columns);
        return;
    }
    for (size_t i = 0; array->count && job_ok(to->job) && i < array->rows; i++) { /* else a side without a lead */
        char name[64];
        double point[3];
        for (size_t k = 0; k < 3; k++) {
            point[k] = matlab_number(array, k * array->rows + i);
        }
        /* Lead 1 is the right one, lead 2 the left one. */
        int size = lead < 2 ? snprintf(name, sizeof name, "%c%zu", "RL"[lead], i + 1)
                            : snprintf(name, sizeof name, "lead%zu-%zu", lead + 1, i + 1);
        pose_add_point(to, to->list->count + 1, point, false, (struct text){name, (size_t)size}, NULL);
    }
}

static void note_space(const struct pose_reading *to, size_t space)
{
    if (space == 0) {
        to->list->space = pose_space_named(text_from("MNI152NLin2009bAsym"), POSE_BRAIN_MNI152);
        job_note(to->job, "contacts are those in MNI space, reco.mni; the format lead-dbs-native takes the "
                          "patient's own");
    } else {
        const char *name = job_format(to->job, "Lead-DBS %s", names[space]);
        to->list->space = pose_space_named(text_from(name), POSE_BRAIN_SUBJECT);
        job_note(to->job, "contacts are those in the patient's own space, reco.%s", names[space]);
    }
    pose_note_space(to->job, to->options, false);
}

/* The contacts of the first space from this one on that there is. */
static void add_contacts(const struct pose_reading *to, const struct matlab *matlab, size_t first)
{
    size_t space = first;
    const struct matlab_array *cells = find_coordinates(matlab, space);
    const struct matlab_array *reco = matlab_variable(matlab, "reco");
    while (!cells && space + 1 < SPACES) {
        cells = find_coordinates(matlab, ++space);
    }
    pose_refuse_axis(to, "contacts");
    if (!cells) {
        bool is_other = reco && reco->kind != MATLAB_STRUCT;
        job_bad(to->job,
                is_other ? "reco: %s, a structure is needed"
                         : "no positions of contacts, reco.%s.coords_mm: no reconstruction of Lead-DBS",
                is_other ? matlab_class_name(reco).text : names[first ? SPACES - 1 : 0]);
        return;
    }
    note_space(to, space);
    if (cells->kind != MATLAB_CELL && cells->count) {
        job_bad(to->job, "coords_mm: %s, a cell array with a cell for each lead is needed",
                matlab_class_name(cells).text);
    }
    for (size_t i = 0; job_ok(to->job) && i < cells->count; i++) {
        add_lead(to, &matlab->arrays[cells->parts + i], i);
    }
}

static void parse_from(struct pose_reading *to, struct text text, size_t space)
{
    if (!matlab_is(text)) {
        job_bad(to->job, "not a file of MATLAB: no reconstruction of Lead-DBS");
    }
    add_contacts(to, pose_matlab(to, text), space);
}

/* The contacts of Lead-DBS's reconstruction, ea_reconstruction.mat or *_desc-reconstruction.mat, as points in MNI
 * space, or in the patient's own where it has no other. text is no longer than pose_memory(). */
void pose_lead_dbs_parse(struct pose_reading *to, struct text text)
{
    parse_from(to, text, 0);
}

/* The same in the patient's own space. */
void pose_lead_dbs_parse_native(struct pose_reading *to, struct text text)
{
    parse_from(to, text, 1);
}

bool pose_lead_dbs_is(struct pose_reading *to, struct text text)
{
    const struct matlab *matlab = pose_matlab(to, text);
    return matlab_variable(matlab, "reco") || matlab_variable(matlab, "coords_mm");
}
