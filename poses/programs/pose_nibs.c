/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses NIBS-BIDS's markers. The proposal (versions 6.0 to 6.3) does not say which way a coil's normal or the axes of
 * its matrix point: a target decides, or the caller. */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"

enum column {
    ID,
    TARGET,
    ENTRY = TARGET + 3,
    DEVICE = ENTRY + 3,
    NORMAL = DEVICE + 3,
    BEAM = NORMAL + 3,
    MATRIX = BEAM + 3,
    PLAIN_X, /* of other tables */
    EVENT,   /* of the proposal's other tables */
    COLUMNS
};

/* Version 6.2 and before, and 6.3. */
static const char *const names[COLUMNS] = {
    "nibs_position_id/position_id/target_id/MarkerID/StimID",
    "target_x/position_x",
    "target_y/position_y",
    "target_z/position_z",
    "entry_x/position_entry_x",
    "entry_y/position_entry_y",
    "entry_z/position_entry_z",
    "coil_x/transducer_x/position_coil_x/position_transducer_x/element_centre_x",
    "coil_y/transducer_y/position_coil_y/position_transducer_y/element_centre_y",
    "coil_z/transducer_z/position_coil_z/position_transducer_z/element_centre_z",
    "normal_x/position_normal_x",
    "normal_y/position_normal_y",
    "normal_z/position_normal_z",
    "beam_x/position_beam_x",
    "beam_y/position_beam_y",
    "beam_z/position_beam_z",
    "coil_transform/position_coil_transform/position_transducer_transform/TransducerTransform/Matrix_4x4/Matrix4D",
    "x",
    "nibs_event_id/event_id",
};

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    struct named_cells cells;
    double scale; /* mm per unit */
    bool lps;
    /* Of the row, by the first column of each: */
    bool has[COLUMNS];
    double at[COLUMNS][3]; /* mm, RAS */
};

bool pose_nibs_header(struct text line)
{
    struct named_cells cells = {.names = names, .count = COLUMNS};
    (void)named_cells_find(&cells, line); /* a column that is there twice is an error of such a table */
    return (cells.at[ID] == 0 || cells.at[EVENT] == 0) && !named_cells_has(&cells, PLAIN_X);
}

static conus_status read_vectors(struct reading *reading)
{
    const struct named_cells *cells = &reading->cells;
    conus_status status = CONUS_OK;
    for (size_t i = TARGET; !status && i < MATRIX; i += 3) {
        double *at = reading->at[i];
        reading->has[i] = !named_cell_is_absent(cells, i) || !named_cell_is_absent(cells, i + 1) ||
                          !named_cell_is_absent(cells, i + 2);
        status = reading->has[i] ? named_cells_numbers(at, cells, i, 3) : CONUS_OK;
        vec3_scale(at, at, reading->scale);
        if (reading->lps) {
            pose_flip_point(at);
        }
    }
    reading->has[MATRIX] = !named_cell_is_absent(cells, MATRIX);
    return status;
}

/* [[row 0], [row 1], [row 2], [row 3]] */
static conus_status pose_by_matrix(conus_pose *out, const struct reading *reading)
{
    double m[16];
    json_t *root = NULL;
    conus_status status = json_text_load(&root, named_cell(&reading->cells, MATRIX));
    bool fine = json_array_size(root) == 4;
    for (size_t i = 0; i < 4 && fine; i++) {
        double row[4];
        fine = json_numbers(row, 4, json_array_get(root, i));
        for (size_t k = 0; k < 4 && fine; k++) {
            m[4 * k + i] = row[k];
        }
    }
    status = status || fine ? status : fail(CONUS_ERROR_DATA, "four lists of four numbers are needed");
    json_decref(root);
    if (status) {
        return fail_in(status, "the coil's matrix");
    }
    for (int i = 0; i < 3; i++) {
        m[12 + i] *= reading->scale;
    }
    return pose_of_matrix(out, m, reading->lps, reading->options->axis);
}

/* Along the normal or against it: towards the target, or as the caller says. */
static conus_status pose_by_normal(conus_pose *out, const struct reading *reading)
{
    const double *device = reading->at[DEVICE];
    conus_axis axis = reading->options->axis;
    double along[3];
    double way[3];
    if (!vec3_normalise(along, reading->at[NORMAL])) {
        return fail(CONUS_ERROR_DATA, "a normal of length 0");
    }
    if (axis == CONUS_AXIS_OF_FORMAT && reading->has[TARGET]) {
        vec3_sub(way, reading->at[TARGET], device);
        double cosine = vec3_normalise(way, way) ? vec3_dot(way, along) : 0;
        if (fabs(cosine) < 0.5) {
            return fail(CONUS_ERROR_DATA, "the normal is %.0f degrees off the target, up to 60 are allowed",
                        degrees_from_radians(acos(fabs(cosine))));
        }
        axis = cosine > 0 ? CONUS_AXIS_PLUS_Z : CONUS_AXIS_MINUS_Z;
    }
    if (axis != CONUS_AXIS_PLUS_Z && axis != CONUS_AXIS_MINUS_Z) {
        return fail(CONUS_ERROR_DATA, "a normal without a target: the proposal does not say whether it points into the "
                                      "head; --axis +z points along it, -z against it");
    }
    vec3_scale(along, along, axis == CONUS_AXIS_PLUS_Z ? 1 : -1);
    return conus_pose_along(out, device, along, NULL);
}

static conus_status marker_pose(conus_pose_row *row, const struct reading *reading)
{
    const bool *has = reading->has;
    const double *from = has[DEVICE] ? reading->at[DEVICE] : reading->at[ENTRY];
    bool has_from = has[DEVICE] || has[ENTRY];
    if (has[MATRIX] && reading->options->axis != CONUS_AXIS_OF_FORMAT) {
        return pose_by_matrix(&row->pose, reading);
    }
    if (has_from && has[BEAM]) {
        return conus_pose_along(&row->pose, from, reading->at[BEAM], NULL);
    }
    if (has[DEVICE] && has[NORMAL]) {
        return pose_by_normal(&row->pose, reading);
    }
    if (has_from && has[TARGET]) {
        return pose_row_toward(row, from, reading->at[TARGET], NULL);
    }
    if (has[MATRIX]) {
        return fail(CONUS_ERROR_DATA, "a matrix: the proposal does not say along which of its axes the coil points; "
                                      "--axis says so (Localite +x, SimNIBS +z, Brainsight -z)");
    }
    row->is_point = has[TARGET];
    return has[TARGET] ? pose_of_point(&row->pose, reading->at[TARGET])
                       : fail(CONUS_ERROR_DATA, "no coordinates of a target, nor of a coil or entry with a direction");
}

static conus_status read_row(struct reading *reading, struct text line, size_t number)
{
    conus_pose_row row = pose_row_at(number);
    conus_status bad = named_cells_split(&reading->cells, line);
    bad = bad ? bad : read_vectors(reading);
    bad = bad ? bad : marker_pose(&row, reading);
    return pose_list_add(reading->list, &row, named_cell(&reading->cells, ID), bad ? conus_message() : NULL);
}

static conus_status read_header(struct reading *reading, struct text line)
{
    conus_status status = named_cells_find(&reading->cells, line);
    if (!status && reading->cells.at[ID] != 0) {
        status = fail(CONUS_ERROR_DATA,
                      "header: the first column is none of %s; of NIBS-BIDS only *_markers.tsv has "
                      "positions, not *_nibs.tsv",
                      names[ID]);
    }
    bool has_axes = named_cells_has(&reading->cells, MATRIX) || named_cells_has(&reading->cells, NORMAL);
    if (!status && reading->options->axis != CONUS_AXIS_OF_FORMAT && !has_axes) {
        status = fail(CONUS_ERROR_DATA, "neither a matrix nor a normal, so that no axis (%s) can be chosen",
                      pose_axis_name(reading->options->axis));
    }
    return status;
}

conus_status pose_nibs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options, .cells = {.names = names, .count = COLUMNS}};
    struct text line;
    bool begun = false;
    reading.scale = list->space.scale > 0 ? list->space.scale : 1;
    bool is_named = list->space.brain != POSE_BRAIN_UNKNOWN && list->space.brain != POSE_BRAIN_OTHER; /* it is RAS */
    reading.lps = options->space == CONUS_SPACE_LPS && !is_named;
    conus_status status = pose_note_space(&list->notes, options, reading.lps);
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        if (text_trim(line).size) {
            status = begun ? read_row(&reading, line, number) : read_header(&reading, line);
            begun = true;
        }
    }
    return status || begun ? status : fail(CONUS_ERROR_DATA, "no header");
}
