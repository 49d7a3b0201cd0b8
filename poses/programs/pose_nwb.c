/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the electrodes of NWB (Neurodata Without Borders): points to posterior, inferior and right, of no unit. */
#include "poses/programs/pose_programs.h"

#include "base/child/hdf5.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <stdio.h>

#define TABLE "/general/extracellular_ephys/electrodes/"

/* Positions of a brain: all of a file nearer to the origin than this are in mm, others in micrometres. */
static const double farthest_mm = 20;

struct table {
    size_t count;
    const struct hdf5_value *axes[3]; /* to posterior, inferior, right */
    const struct hdf5_value *ids;
    const struct hdf5_value *groups; /* their names; NULL = there are none */
    double um;                       /* micrometres of the file's unit */
};

/* A column of as many rows as x has; NULL where it is not there, which is an error of those that are needed. */
static conus_status find_column(const struct hdf5_value **out, const struct table *table, const struct hdf5 *hdf5,
                                const char *path, bool is_text)
{
    const struct hdf5_object *object = hdf5_find(hdf5, path);
    const struct hdf5_value *value = object ? &object->value : NULL;
    bool fine = !value || (value->rank == 1 && (is_text ? value->class == HDF5_STRING : hdf5_is_number(value)) &&
                           (!table->axes[0] || value->count == table->count));
    *out = value;
    return fine ? CONUS_OK
                : fail(CONUS_ERROR_DATA, "%s: %s for each electrode is needed", path, is_text ? "a text" : "a number");
}

static conus_status find_table(struct table *out, const struct hdf5 *hdf5)
{
    static const char *const axes[] = {TABLE "x", TABLE "y", TABLE "z"};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 3; i++) {
        status = find_column(&out->axes[i], out, hdf5, axes[i], false);
        out->count = out->axes[0] ? out->axes[0]->count : 0;
        if (!status && !out->axes[i]) {
            status = fail(CONUS_ERROR_DATA, "HDF5, but neither of MATLAB nor electrodes of NWB with positions: no %s",
                          axes[i]);
        }
    }
    status = status ? status : find_column(&out->ids, out, hdf5, TABLE "id", false);
    status = status ? status : find_column(&out->groups, out, hdf5, TABLE "group_name", true);
    return status || (out->ids && out->ids->class != HDF5_FLOAT)
               ? status
               : fail(CONUS_ERROR_DATA, TABLE "id: a whole number for each electrode is needed");
}

/* False where a number is missing. */
static bool get_point(double out[3], const struct table *table, size_t row)
{
    bool fine = true;
    for (size_t i = 0; i < 3; i++) {
        out[i] = hdf5_number(table->axes[i], row);
        fine = fine && isfinite(out[i]);
    }
    return fine;
}

/* Finds the unit, and what shows that the positions are not those in the brain. */
static conus_status judge(conus_pose_list *list, struct table *table)
{
    double farthest = 0;
    double first[3] = {0};
    size_t known = 0;
    bool twice = true; /* z repeats y */
    bool flat = true;  /* one z, and y in steps of 20, as sites lie on a probe */
    for (size_t i = 0; i < table->count; i++) {
        double p[3];
        if (get_point(p, table, i)) {
            first[2] = known++ ? first[2] : p[2];
            farthest = fmax(farthest, fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2]))));
            twice = twice && p[1] == p[2];
            flat = flat && p[2] == first[2] && fmod(p[1], 20) == 0;
        }
    }
    if (known && twice) {
        return fail(CONUS_ERROR_DATA, "columns y and z are equal in every row, as AllenSDK wrote them: left and right "
                                      "are missing");
    }
    table->um = farthest > farthest_mm ? 1 : 1000;
    conus_status status = known > 1 && flat
                              ? notes_warn(&list->notes, "all positions have one z, and y in steps of 20: "
                                                         "are they on the probe, not in the brain?")
                              : CONUS_OK;
    return status ? status
                  : notes_add(&list->notes,
                              "NWB states no unit: positions are taken as %s, to posterior, inferior and right",
                              table->um == 1 ? "micrometres" : "mm");
}

/* To the frame's space: in CCF as the file has them, from bregma AP, ML, DV to anterior, right and up. */
static conus_status find_point(double world[3], const struct table *table, const conus_frame *frame, const double p[3])
{
    const double um = table->um;
    const double ccf[3] = {p[0] * um, p[1] * um, p[2] * um};
    const double mm[3] = {-ccf[0] / 1000, ccf[2] / 1000, -ccf[1] / 1000};
    return conus_frame_to_world(world, frame, frame->space == CONUS_SPACE_CCF ? ccf : mm);
}

static conus_status add_electrode(conus_pose_list *list, const struct table *table, const conus_frame *frame,
                                  size_t index)
{
    char name[POSE_ID_LIMIT + 2]; /* one byte more than is allowed, so that more is seen */
    double p[3];
    double world[3] = {0};
    conus_pose_row row = pose_row_at(list->count + 1);
    row.is_point = true;
    struct text group = table->groups ? hdf5_string(table->groups, index) : text_from("");
    int size = snprintf(name, sizeof name, "%.*s%s%lld", TEXT_SHOW(group, sizeof name), group.size ? "-" : "",
                        (long long)hdf5_whole(table->ids, index));
    struct text id = {name, (size_t)size < sizeof name ? (size_t)size : sizeof name - 1};
    conus_status bad =
        get_point(p, table, index) ? find_point(world, table, frame, p) : fail(CONUS_ERROR_DATA, "x, y, z: not known");
    bad = bad ? bad : pose_of_point(&row.pose, world);
    return pose_list_add(list, &row, id, bad ? conus_message() : NULL);
}

conus_status pose_nwb_from_hdf5(conus_pose_list *list, const struct hdf5 *hdf5, const conus_pose_options *options)
{
    struct table table = {0};
    conus_status status = find_table(&table, hdf5);
    status = status ? status : judge(list, &table);
    if (!status && hdf5_find(hdf5, "/general/localization")) {
        status = notes_warn(&list->notes, "the file has /general/localization, too, which is not read");
    }
    for (size_t i = 0; !status && i < table.count; i++) {
        status = add_electrode(list, &table, options->frame, i);
    }
    return status;
}

conus_status pose_nwb_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    static const char *const wanted[] = {TABLE "x",  TABLE "y",          TABLE "z",
                                         TABLE "id", TABLE "group_name", "/general/localization"};
    struct hdf5 *hdf5 = NULL;
    if (options->axis != CONUS_AXIS_OF_FORMAT) {
        return fail(CONUS_ERROR_DATA, "electrodes have no axes, so that no axis (%s) can be chosen",
                    pose_axis_name(options->axis));
    }
    uint64_t left = pose_memory(options) - text.size;
    conus_status status = hdf5_read_bytes(&hdf5, text, wanted, sizeof wanted / sizeof wanted[0], left ? left : 1);
    if (!status && hdf5_find(hdf5, TABLE "x") && options->space < CONUS_SPACE_CCF) {
        status =
            fail(CONUS_ERROR_DATA, "NWB states neither the origin nor the unit of its positions: space ccf or bregma "
                                   "is needed");
    }
    status = status ? status : pose_nwb_from_hdf5(list, hdf5, options);
    hdf5_destroy(hdf5);
    return status;
}
