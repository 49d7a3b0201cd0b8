/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses InVesalius's table of markers. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"

static const char first_line[] = "##INVESALIUS3_MARKER_FILE_";

enum { NEWEST_VERSION = 4 };

enum column { LABEL, TYPE, ALPHA, X, Y, Z, ALPHA_WORLD, BETA_WORLD, GAMMA_WORLD, COLUMNS };

static const char *const names[COLUMNS] = {"label",   "marker_type", "alpha",      "x_world",    "y_world",
                                           "z_world", "alpha_world", "beta_world", "gamma_world"};

struct reading {
    struct job *job;
    struct pose_reading *to;
    struct named_cells cells;
    size_t fiducials;
};

static void read_version(const struct reading *reading, struct text line)
{
    enum { SKIPPED = sizeof first_line - 1 };
    struct text number = text_trim((struct text){line.data + SKIPPED, line.size - SKIPPED});
    uint64_t version;
    if (!text_to_uint(number, UINT32_MAX, &version)) {
        job_bad(reading->job, "%s: \"%.*s\" is no version", first_line, POSE_QUOTE(number));
    } else if (version > NEWEST_VERSION) {
        job_note(reading->job,
                 "markers of InVesalius, version %llu; 0 to %d are known, and this one is read as they are",
                 (unsigned long long)version, NEWEST_VERSION);
    }
}

static void read_header(struct reading *reading, struct text line)
{
    named_cells_find(reading->job, &reading->cells, line);
    for (size_t i = X; i < COLUMNS; i++) {
        if (!named_cells_has(&reading->cells, i)) {
            job_bad(reading->job,
                    "markers of InVesalius without the column %s: x, y and z are in its own space, which only its "
                    "image tells; save them anew with a version that writes x_world",
                    names[i]);
        }
    }
}

/* Angles about fixed axes, first x, then y, then z, in degrees. */
static void turn_by(double m[16], const double degrees[3])
{
    double c[3];
    double s[3];
    for (int i = 0; i < 3; i++) {
        c[i] = cos(radians_from_degrees(degrees[i]));
        s[i] = sin(radians_from_degrees(degrees[i]));
    }
    const double columns[3][3] = {
        {c[1] * c[2], c[1] * s[2], -s[1]},
        {s[0] * s[1] * c[2] - c[0] * s[2], s[0] * s[1] * s[2] + c[0] * c[2], s[0] * c[1]},
        {c[0] * s[1] * c[2] + s[0] * s[2], c[0] * s[1] * s[2] - s[0] * c[2], c[0] * c[1]},
    };
    for (int i = 0; i < 12; i++) {
        m[i] = i % 4 < 3 ? columns[i / 4][i % 4] : 0;
    }
}

/* The world columns of a marker without orientation have one nevertheless. */
static void read_pose(conus_pose_row *row, const struct reading *reading)
{
    double position[3] = {0};
    double angles[3] = {0};
    double m[16] = {[15] = 1};
    if (named_cell_is_absent(&reading->cells, X)) {
        job_bad(reading->job, "x_world: not known; InVesalius knows the world of NIfTI images only");
        return;
    }
    named_cells_numbers(reading->job, position, &reading->cells, X, 3);
    row->is_point = named_cells_has(&reading->cells, ALPHA) && named_cell_is_absent(&reading->cells, ALPHA);
    if (row->is_point) {
        (void)JOB_CALL(reading->job, pose_of_point(&row->pose, position));
        return;
    }
    named_cells_numbers(reading->job, angles, &reading->cells, ALPHA_WORLD, 3);
    turn_by(m, angles);
    memcpy(m + 12, position, sizeof position);
    (void)JOB_CALL(reading->job, pose_of_matrix(&row->pose, m, false, reading->to->options->axis));
}

static void read_row(struct reading *reading, struct text line, size_t number)
{
    conus_pose_row row = pose_row_at(number);
    const struct attempt attempt = job_try(reading->job);
    named_cells_split(reading->job, &reading->cells, line);
    struct text label = named_cell(&reading->cells, LABEL);
    struct text type = named_cell(&reading->cells, TYPE);
    /* Points on the head, for registration. Old files know them by their labels. */
    bool is_fiducial = type.size ? text_equal(type, "0") : text_is_one_of(label, "LEI/REI/NAI", true);
    is_fiducial = is_fiducial && job_ok(reading->job);
    if (job_ok(reading->job) && !is_fiducial) {
        read_pose(&row, reading);
    }
    const char *bad = attempt_end(reading->job, &attempt, ATTEMPT_TRY);
    reading->fiducials += is_fiducial;
    if (!is_fiducial) {
        pose_add(reading->to, &row, label, bad);
    }
}

/* InVesalius's markers, .mkss, by their world columns: poses of the coil, and points. */
void pose_invesalius_parse(struct pose_reading *to, struct text text)
{
    struct reading reading = {.job = to->job, .to = to, .cells = {.names = names, .count = COLUMNS}};
    to->list->space = pose_space_named(text_from("InVesalius world"), POSE_BRAIN_SUBJECT);
    pose_note_space(to->job, to->options, false);
    struct text line;
    if (!text_line(&text, &line) || !text_starts(line, first_line)) {
        job_bad(to->job, "the first line is not %s0 to %d", first_line, NEWEST_VERSION);
        return;
    }
    read_version(&reading, line);
    bool begun = false;
    for (size_t number = 2; job_ok(to->job) && text_line(&text, &line); number++) {
        if (text_trim(line).size && begun) {
            read_row(&reading, line, number);
        } else if (text_trim(line).size) {
            read_header(&reading, line);
            begun = true;
        }
    }
    if (!begun) {
        job_bad(to->job, "markers of InVesalius without a header");
    }
    if (reading.fiducials) {
        job_note(to->job, "%zu fiducials were passed over", reading.fiducials);
    }
}
