/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses NIBS-BIDS's markers. The proposal (versions 6.0 to 6.3) does not say which way a coil's normal or the axes of
 * its matrix point: a target decides, or the caller. */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "poses/rows/pose_columns.h"
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
    "nibs_position_id|position_id|target_id|MarkerID|StimID",
    "target_x|position_x",
    "target_y|position_y",
    "target_z|position_z",
    "entry_x|position_entry_x",
    "entry_y|position_entry_y",
    "entry_z|position_entry_z",
    "coil_x|transducer_x|position_coil_x|position_transducer_x|element_centre_x",
    "coil_y|transducer_y|position_coil_y|position_transducer_y|element_centre_y",
    "coil_z|transducer_z|position_coil_z|position_transducer_z|element_centre_z",
    "normal_x|position_normal_x",
    "normal_y|position_normal_y",
    "normal_z|position_normal_z",
    "beam_x|position_beam_x",
    "beam_y|position_beam_y",
    "beam_z|position_beam_z",
    "coil_transform|position_coil_transform|position_transducer_transform|TransducerTransform|Matrix_4x4|Matrix4D",
    "x",
    "nibs_event_id|event_id",
};

/* The points and directions of a row, in mm and RAS. */
struct marker {
    bool has[COLUMNS]; /* by the first column of each */
    double at[COLUMNS][3];
    struct text matrix;
};

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    struct pose_columns columns;
    double scale; /* mm per unit */
    bool lps;
};

static const enum column vectors[] = {TARGET, ENTRY, DEVICE, NORMAL, BEAM};

enum { VECTORS = sizeof vectors / sizeof vectors[0] };

bool pose_nibs_header(struct text line)
{
    struct pose_columns columns = {.names = names, .count = COLUMNS};
    (void)pose_columns_find(&columns, line); /* a column that is there twice is an error of such a table */
    return (columns.at[ID] == 0 || columns.at[EVENT] == 0) && !pose_columns_has(&columns, PLAIN_X);
}

static conus_status read_vectors(struct marker *out, const struct reading *reading, const struct text *fields)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < VECTORS; i++) {
        enum column first = vectors[i];
        for (size_t k = 0; k < 3; k++) {
            out->has[first] = out->has[first] || !pose_field_is_absent(fields[first + k]);
        }
        if (out->has[first]) {
            status = pose_columns_point(out->at[first], &reading->columns, fields, first, reading->scale);
        }
        if (reading->lps) {
            pose_flip_point(out->at[first]);
        }
    }
    out->has[MATRIX] = !pose_field_is_absent(fields[MATRIX]);
    out->matrix = fields[MATRIX];
    return status;
}

/* [[row 0], [row 1], [row 2], [row 3]] */
static conus_status pose_by_matrix(conus_pose *out, const struct reading *reading, const struct marker *marker)
{
    double m[16];
    json_t *root = NULL;
    conus_status status = json_text_load(&root, marker->matrix);
    for (size_t i = 0; !status && i < 16; i++) {
        const json_t *row = json_array_get(root, i / 4);
        const json_t *value = json_array_get(row, i % 4);
        m[4 * (i % 4) + i / 4] = json_number_value(value);
        if (!json_is_number(value) || json_array_size(root) != 4 || json_array_size(row) != 4) {
            status = fail(CONUS_ERROR_DATA, "four lists of four numbers are needed");
        }
    }
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
static conus_status pose_by_normal(conus_pose *out, const struct reading *reading, const struct marker *marker)
{
    const double *device = marker->at[DEVICE];
    conus_axis axis = reading->options->axis;
    double along[3];
    double way[3];
    if (!vec3_normalise(along, marker->at[NORMAL])) {
        return fail(CONUS_ERROR_DATA, "a normal of length 0");
    }
    if (axis == CONUS_AXIS_OF_FORMAT && marker->has[TARGET]) {
        vec3_sub(way, marker->at[TARGET], device);
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

static conus_status marker_pose(conus_pose_row *row, const struct reading *reading, const struct marker *marker)
{
    const bool *has = marker->has;
    const double *from = has[DEVICE] ? marker->at[DEVICE] : marker->at[ENTRY];
    bool has_from = has[DEVICE] || has[ENTRY];
    if (has[MATRIX] && reading->options->axis != CONUS_AXIS_OF_FORMAT) {
        return pose_by_matrix(&row->pose, reading, marker);
    }
    if (has_from && has[BEAM]) {
        return conus_pose_along(&row->pose, from, marker->at[BEAM], NULL);
    }
    if (has[DEVICE] && has[NORMAL]) {
        return pose_by_normal(&row->pose, reading, marker);
    }
    if (has_from && has[TARGET]) {
        return pose_row_toward(row, from, marker->at[TARGET], NULL);
    }
    if (has[MATRIX]) {
        return fail(CONUS_ERROR_DATA, "a matrix: the proposal does not say along which of its axes the coil points; "
                                      "--axis says so (Localite +x, SimNIBS +z, Brainsight -z)");
    }
    row->is_point = has[TARGET];
    return has[TARGET] ? pose_of_point(&row->pose, marker->at[TARGET])
                       : fail(CONUS_ERROR_DATA, "no coordinates of a target, nor of a coil or entry with a direction");
}

static conus_status read_row(const struct reading *reading, struct text line, size_t number)
{
    struct text fields[COLUMNS];
    struct marker marker = {0};
    conus_pose_row row = pose_row_at(number);
    conus_status bad = pose_columns_split(fields, &reading->columns, line);
    bad = bad ? bad : read_vectors(&marker, reading, fields);
    bad = bad ? bad : marker_pose(&row, reading, &marker);
    return pose_list_add(reading->list, &row, fields[ID], bad ? conus_message() : NULL);
}

static conus_status read_header(struct reading *reading, struct text line)
{
    conus_status status = pose_columns_find(&reading->columns, line);
    if (!status && reading->columns.at[ID] != 0) {
        status = fail(CONUS_ERROR_DATA,
                      "header: the first column is none of %s; of NIBS-BIDS only *_markers.tsv has "
                      "positions, not *_nibs.tsv",
                      names[ID]);
    }
    bool has_axes = pose_columns_has(&reading->columns, MATRIX) || pose_columns_has(&reading->columns, NORMAL);
    if (!status && reading->options->axis != CONUS_AXIS_OF_FORMAT && !has_axes) {
        status = fail(CONUS_ERROR_DATA, "neither a matrix nor a normal, so that no axis (%s) can be chosen",
                      pose_axis_name(reading->options->axis));
    }
    return status;
}

conus_status pose_nibs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options, .columns = {.names = names, .count = COLUMNS}};
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
