/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses NIBS-BIDS's markers. The proposal (versions 6.0 to 6.3) does not say which way a coil's normal or the axes of
 * its matrix point: a target decides, or the caller. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "poses/rows/columns.h"
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
    struct job *job;
    struct pose_reading *to;
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
    named_cells_find(NULL, &cells, line); /* a column that is there twice is an error of such a table */
    return (cells.at[ID] == 0 || cells.at[EVENT] == 0) && !named_cells_has(&cells, PLAIN_X);
}

static void read_vectors(struct reading *reading)
{
    const struct named_cells *cells = &reading->cells;
    for (size_t i = TARGET; job_ok(reading->job) && i < MATRIX; i += 3) {
        double *at = reading->at[i];
        reading->has[i] = !named_cell_is_absent(cells, i) || !named_cell_is_absent(cells, i + 1) ||
                          !named_cell_is_absent(cells, i + 2);
        if (reading->has[i]) {
            named_cells_numbers(reading->job, at, cells, i, 3);
        }
        vec3_scale(at, at, reading->scale);
        if (reading->lps) {
            pose_flip_point(at);
        }
    }
    reading->has[MATRIX] = !named_cell_is_absent(cells, MATRIX);
}

/* [[row 0], [row 1], [row 2], [row 3]] */
static void pose_by_matrix(conus_pose *out, const struct reading *reading)
{
    struct job *job = reading->job;
    double m[16];
    const size_t mark = job_in(job, "the coil's matrix", JOB_ALONE);
    json_t *root = json_text_read(job, named_cell(&reading->cells, MATRIX));
    bool fine = json_array_size(root) == 4;
    for (size_t i = 0; i < 4 && fine; i++) {
        double row[4];
        fine = json_numbers(row, 4, json_array_get(root, i));
        for (size_t k = 0; k < 4 && fine; k++) {
            m[4 * k + i] = row[k] * (k == 3 && i < 3 ? reading->scale : 1);
        }
    }
    if (!fine) {
        job_bad(job, "four lists of four numbers are needed");
    }
    job_out(job, mark);
    (void)JOB_CALL(job, pose_of_matrix(out, m, reading->lps, reading->to->options->axis));
}

/* Along the normal or against it: towards the target, or as the caller says. */
static void pose_by_normal(conus_pose *out, const struct reading *reading)
{
    const double *device = reading->at[DEVICE];
    conus_axis axis = reading->to->options->axis;
    double along[3];
    double way[3];
    if (!vec3_normalise(along, reading->at[NORMAL])) {
        job_bad(reading->job, "a normal of length 0");
        return;
    }
    if (axis == CONUS_AXIS_OF_FORMAT && reading->has[TARGET]) {
        vec3_sub(way, reading->at[TARGET], device);
        double cosine = vec3_normalise(way, way) ? vec3_dot(way, along) : 0;
        if (fabs(cosine) < 0.5) {
            job_bad(reading->job, "the normal is %.0f degrees off the target, up to 60 are allowed",
                    degrees_from_radians(acos(fabs(cosine))));
        }
        axis = cosine > 0 ? CONUS_AXIS_PLUS_Z : CONUS_AXIS_MINUS_Z;
    }
    if (axis != CONUS_AXIS_PLUS_Z && axis != CONUS_AXIS_MINUS_Z) {
        job_bad(reading->job, "a normal without a target: the proposal does not say whether it points into the "
                              "head; --axis +z points along it, -z against it");
    }
    vec3_scale(along, along, axis == CONUS_AXIS_PLUS_Z ? 1 : -1);
    (void)JOB_CALL(reading->job, conus_pose_along(out, device, along, NULL));
}

static void marker_pose(conus_pose_row *row, const struct reading *reading)
{
    struct job *job = reading->job;
    const bool *has = reading->has;
    const double *from = has[DEVICE] ? reading->at[DEVICE] : reading->at[ENTRY];
    bool has_from = has[DEVICE] || has[ENTRY];
    if (has[MATRIX] && reading->to->options->axis != CONUS_AXIS_OF_FORMAT) {
        pose_by_matrix(&row->pose, reading);
    } else if (has_from && has[BEAM]) {
        (void)JOB_CALL(job, conus_pose_along(&row->pose, from, reading->at[BEAM], NULL));
    } else if (has[DEVICE] && has[NORMAL]) {
        pose_by_normal(&row->pose, reading);
    } else if (has_from && has[TARGET]) {
        (void)JOB_CALL(job, pose_row_toward(row, from, reading->at[TARGET], NULL));
    } else if (has[MATRIX]) {
        job_bad(job, "a matrix: the proposal does not say along which of its axes the coil points; "
                     "--axis says so (Localite +x, SimNIBS +z, Brainsight -z)");
    } else if (has[TARGET]) {
        row->is_point = true;
        (void)JOB_CALL(job, pose_of_point(&row->pose, reading->at[TARGET]));
    } else {
        job_bad(job, "no coordinates of a target, nor of a coil or entry with a direction");
    }
}

static void read_row(struct reading *reading, struct text line, size_t number)
{
    conus_pose_row row = pose_row_at(number);
    const struct job_mark mark = job_mark(reading->job);
    const struct attempt attempt = job_try(reading->job);
    named_cells_split(reading->job, &reading->cells, line);
    read_vectors(reading);
    if (job_ok(reading->job)) { /* else it is no point either */
        marker_pose(&row, reading);
    }
    const char *bad = attempt_end(reading->job, &attempt, ATTEMPT_TRY);
    pose_add(reading->to, &row, named_cell(&reading->cells, ID), bad);
    job_release(reading->job, mark);
}

static void read_header(struct reading *reading, struct text line)
{
    const conus_axis axis = reading->to->options->axis;
    named_cells_find(reading->job, &reading->cells, line);
    if (reading->cells.at[ID] != 0) {
        job_bad(reading->job,
                "header: the first column is none of %s; of NIBS-BIDS only *_markers.tsv has positions, not *_nibs.tsv",
                names[ID]);
    }
    if (axis != CONUS_AXIS_OF_FORMAT && !named_cells_has(&reading->cells, MATRIX) &&
        !named_cells_has(&reading->cells, NORMAL)) {
        job_bad(reading->job, "neither a matrix nor a normal, so that no axis (%s) can be chosen",
                pose_axis_name(axis));
    }
}

/* The *_markers.tsv of the proposal NIBS-BIDS (BEP037), in units of list->space: poses, or points where there is only
 * a target. */
void pose_nibs_parse(struct pose_reading *to, struct text text)
{
    const struct pose_space *space = &to->list->space;
    bool is_named = space->brain != POSE_BRAIN_UNKNOWN && space->brain != POSE_BRAIN_OTHER; /* it is RAS */
    struct reading reading = {.job = to->job,
                              .to = to,
                              .cells = {.names = names, .count = COLUMNS},
                              .scale = space->scale > 0 ? space->scale : 1,
                              .lps = to->options->space == CONUS_SPACE_LPS && !is_named};
    struct text line;
    bool begun = false;
    pose_note_space(to->job, to->options, reading.lps);
    for (size_t number = 1; job_ok(to->job) && text_line(&text, &line); number++) {
        if (text_trim(line).size && begun) {
            read_row(&reading, line, number);
        } else if (text_trim(line).size) {
            read_header(&reading, line);
            begun = true;
        }
    }
    if (!begun) {
        job_bad(to->job, "no header");
    }
}
