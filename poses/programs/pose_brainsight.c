/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Brainsight's export, section by section. */
#include "poses/programs/pose_programs.h"

#include "base/formats/table.h"
#include "base/geometry/math3.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

enum column { X, Y, Z, M00, M22 = M00 + 8, DATE, CLOCK, COLUMNS };

static const char *const names[COLUMNS] = {"Loc. X", "Loc. Y", "Loc. Z", "m0n0", "m0n1", "m0n2", "m1n0",
                                           "m1n1",   "m1n2",   "m2n0",   "m2n1", "m2n2", "Date", "Time"};

enum kind { TARGETS, SAMPLES, ELECTRODES, KINDS };

static const struct {
    const char *column; /* the first, by which a section is detected */
    const char *prefix;
} kinds[KINDS] = {{"Target Name", "target"}, {"Sample Name", "sample"}, {"Electrode Name", "electrode"}};

struct reading {
    struct job *job;
    struct pose_reading *to;
    bool lps;
    bool has_space;
    enum kind kind; /* of the section; KINDS if its rows are passed over */
    struct named_cells cells;
    size_t rows[KINDS]; /* of each kind, in the whole file */
    size_t passed_over; /* rows of other sections */
    size_t line;
    bool has_section;
    bool counting; /* only `rows`, and what a comma is in its numbers, are wanted */
};

static bool has_prefix(struct text text, const char *prefix, struct text *rest)
{
    if (!text_starts(text, prefix)) {
        return false;
    }
    size_t size = text_from(prefix).size;
    *rest = text_trim((struct text){text.data + size, text.size - size});
    return true;
}

/* NIfTI:Scanner, NIfTI:S:Scanner (of the sform), World: the image's world in mm. MNI-152 and Talairach stand alone,
 * too, where the project's image is no NIfTI. */
static void read_space(struct reading *reading, struct text name)
{
    struct text rest;
    bool nifti = has_prefix(name, "NIfTI:", &rest);
    if (text_is_one_of(name, "MNI-152/Talairach", true)) {
        nifti = true;
        rest = name;
    }
    if (nifti && !has_prefix(rest, "S:", &rest)) {
        (void)has_prefix(rest, "Q:", &rest);
    }
    enum pose_brain brain = !nifti                          ? POSE_BRAIN_SUBJECT
                            : text_equal(rest, "Scanner")   ? POSE_BRAIN_SUBJECT
                            : text_equal(rest, "MNI-152")   ? POSE_BRAIN_MNI152
                            : text_equal(rest, "Talairach") ? POSE_BRAIN_TALAIRACH
                                                            : POSE_BRAIN_UNKNOWN;
    if (!nifti && !text_equal(name, "World")) {
        job_bad(reading->job,
                "coordinate system \"%.*s\" is not the world of an image; export as NIfTI:Scanner, "
                "NIfTI:Aligned, NIfTI:MNI-152, NIfTI:Talairach or World",
                POSE_QUOTE(name));
    }
    reading->lps = !nifti;
    reading->has_space = true;
    reading->to->list->space = pose_space_named(name, brain);
}

/* "# Target Name, Loc. X, ...", separated by tabs. */
static void begin_section(struct reading *reading, struct text header)
{
    struct named_cells *cells = &reading->cells;
    named_cells_find(NULL, cells, header);
    reading->has_section = true;
    reading->kind = TARGETS;
    while (reading->kind < KINDS && !text_equal(cells->line.cells[0], kinds[reading->kind].column)) {
        reading->kind++;
    }
    if (reading->kind == KINDS) {
        return;
    }
    named_cells_find(reading->job, cells, header);
    size_t found = 0;
    for (size_t i = X; i <= M22; i++) {
        found += named_cells_has(cells, i);
        if (i == Z && found < 3) {
            job_bad(reading->job, "no columns Loc. X, Loc. Y, Loc. Z");
        }
    }
    if (found != 3 && found != 12) {
        job_bad(reading->job, "only some of the columns m0n0...m2n2");
    }
}

static void read_comment(struct reading *reading, struct text line)
{
    struct text rest = text_trim((struct text){line.data + 1, line.size - 1});
    struct text value;
    if (has_prefix(rest, "Coordinate system:", &value)) {
        read_space(reading, value);
    } else if (has_prefix(rest, "Units:", &value) || has_prefix(rest, "units:", &value)) {
        if (!text_starts(value, "millimetres") && !text_starts(value, "millimeters") && !text_starts(value, "mm")) {
            job_bad(reading->job, "units \"%.*s\", millimetres are needed", POSE_QUOTE(value));
        }
    } else if (memchr(rest.data, '\t', rest.size)) {
        begin_section(reading, rest);
    }
}

/* m0n0 m0n1 m0n2 is where the device's x points, and so on. */
static void read_matrix(conus_pose *out, const struct reading *reading, const double position[3])
{
    double axes[9] = {0};
    double m[16] = {[15] = 1};
    named_cells_numbers(reading->job, axes, &reading->cells, M00, 9);
    for (int i = 0; i < 3; i++) {
        memcpy(m + 4 * i, axes + 3 * i, 3 * sizeof *m);
    }
    memcpy(m + 12, position, 3 * sizeof *m);
    (void)JOB_CALL(reading->job, pose_of_matrix(out, m, reading->lps, reading->to->options->axis));
}

static void read_pose(conus_pose_row *row, const struct reading *reading)
{
    double position[3] = {0};
    named_cells_numbers(reading->job, position, &reading->cells, X, 3);
    row->time_s = pose_clock(named_cell(&reading->cells, DATE), named_cell(&reading->cells, CLOCK));
    row->is_point = job_ok(reading->job);
    for (size_t i = M00; i <= M22; i++) {
        row->is_point = row->is_point && named_cell_is_absent(&reading->cells, i);
    }
    if (!row->is_point) {
        read_matrix(&row->pose, reading, position);
        return;
    }
    if (reading->lps) {
        pose_flip_point(position);
    }
    (void)JOB_CALL(reading->job, pose_of_point(&row->pose, position));
}

/* Targets, samples and electrodes may have the same names: where there are several kinds, names say which. */
static struct text full_name(char out[POSE_ID_LIMIT + 1], const struct reading *reading, struct text name)
{
    size_t count = 0;
    for (int i = 0; i < KINDS; i++) {
        count += reading->rows[i] > 0;
    }
    int size = count > 1 && name.size <= POSE_ID_LIMIT
                   ? snprintf(out, POSE_ID_LIMIT + 1, "%s/%.*s", kinds[reading->kind].prefix, (int)name.size, name.data)
                   : 0;
    return size > 0 && size <= POSE_ID_LIMIT ? (struct text){out, (size_t)size} : name;
}

static void read_row(struct reading *reading, struct text line)
{
    if (reading->kind == KINDS) {
        reading->passed_over++;
        return;
    }
    if (reading->counting) {
        struct text field;
        for (bool more = memchr(line.data, ',', line.size); text_field(&line, '\t', &more, &field);) {
            table_add_comma(&reading->cells.table, field);
        }
        reading->rows[reading->kind]++;
        return;
    }
    if (!reading->has_space) {
        job_bad(reading->job,
                "a row, and no line \"# Coordinate system: ...\" above it, as Brainsight writes it: put that "
                "back, as \"# Coordinate system: NIfTI:Aligned\", or export again");
    }
    char buffer[POSE_ID_LIMIT + 1];
    conus_pose_row row = pose_row_at(reading->line);
    const struct attempt attempt = job_try(reading->job);
    named_cells_split(reading->job, &reading->cells, line);
    if (job_ok(reading->job)) { /* else its time is not known */
        read_pose(&row, reading);
    }
    const char *bad = attempt_end(reading->job, &attempt, ATTEMPT_TRY);
    pose_add(reading->to, &row, full_name(buffer, reading, reading->cells.line.cells[0]), bad);
}

static void read_lines(struct reading *reading, struct text text)
{
    struct text line;
    reading->kind = KINDS;
    reading->passed_over = 0;
    const size_t mark = job_in(reading->job, "line ", 0);
    for (reading->line = 1; job_ok(reading->job) && text_line(&text, &line); reading->line++) {
        job_at(reading->job, "line ", reading->line);
        if (text_trim(line).size) {
            (line.data[0] == '#' ? read_comment : read_row)(reading, line);
        }
    }
    job_out(reading->job, mark);
}

/* Brainsight's export: sections of targets, samples and electrodes; landmarks are passed over. */
void pose_brainsight_parse(struct pose_reading *to, struct text text)
{
    struct reading reading = {.job = to->job, .to = to, .counting = true};
    reading.cells = (struct named_cells){
        .names = names,
        .count = COLUMNS,
        .needed = DATE,
        .may_be_longer = true,
        .table = {TABLE_TABS, .quotes_are_plain = true},
    };
    read_lines(&reading, text);
    reading.counting = false;
    reading.has_space = false;
    read_lines(&reading, text);
    if (!reading.has_section && reading.passed_over) {
        job_bad(to->job, "no header of a section with tabs between its columns, as Brainsight writes them: "
                         "was it saved with commas or semicolons?");
    }
    if (reading.passed_over) {
        job_note(to->job, "%zu rows of landmarks and other sections were passed over", reading.passed_over);
    }
    pose_note_space(to->job, to->options, reading.lps);
}
