/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Brainsight's export, section by section. */
#include "poses/programs/pose_programs.h"

#include "base/formats/table.h"
#include "base/geometry/math3.h"
#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>

enum column { X, Y, Z, M00, M22 = M00 + 8, DATE, CLOCK, COLUMNS };

static const char *const names[COLUMNS] = {"Loc. X", "Loc. Y", "Loc. Z", "m0n0", "m0n1", "m0n2", "m1n0",
                                           "m1n1",   "m1n2",   "m2n0",   "m2n1", "m2n2", "Date", "Time"};

enum kind { TARGETS, SAMPLES, ELECTRODES, KINDS };

static const struct {
    const char *column; /* the first, by which a section is detected */
    const char *prefix;
} kinds[KINDS] = {{"Target Name", "target"}, {"Sample Name", "sample"}, {"Electrode Name", "electrode"}};

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
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

bool pose_brainsight_line(struct text line)
{
    struct text rest;
    bool found = has_prefix(line, "# Coordinate system:", &rest);
    for (size_t i = 0; i < KINDS && has_prefix(line, "#", &rest); i++) {
        found = found || text_starts(rest, kinds[i].column);
    }
    return found;
}

/* NIfTI:Scanner, NIfTI:S:Scanner (of the sform), World: the image's world in mm. MNI-152 and Talairach stand alone,
 * too, where the project's image is no NIfTI. */
static conus_status read_space(struct reading *reading, struct text name)
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
        return fail(CONUS_ERROR_DATA,
                    "coordinate system \"%.*s\" is not the world of an image; export as NIfTI:Scanner, "
                    "NIfTI:Aligned, NIfTI:MNI-152, NIfTI:Talairach or World",
                    POSE_QUOTE(name));
    }
    reading->lps = !nifti;
    reading->has_space = true;
    reading->list->space = pose_space_named(name, brain);
    return CONUS_OK;
}

/* "# Target Name, Loc. X, ...", separated by tabs. */
static conus_status begin_section(struct reading *reading, struct text header)
{
    struct named_cells *cells = &reading->cells;
    conus_status status = named_cells_find(cells, header);
    reading->has_section = true;
    reading->kind = TARGETS;
    while (reading->kind < KINDS && !text_equal(cells->line.cells[0], kinds[reading->kind].column)) {
        reading->kind++;
    }
    if (status || reading->kind == KINDS) {
        return reading->kind == KINDS ? CONUS_OK : status;
    }
    size_t found = 0;
    for (size_t i = X; i <= M22; i++) {
        found += named_cells_has(cells, i);
        if (i == Z && found < 3) {
            return fail(CONUS_ERROR_DATA, "no columns Loc. X, Loc. Y, Loc. Z");
        }
    }
    return found == 3 || found == 12 ? CONUS_OK : fail(CONUS_ERROR_DATA, "only some of the columns m0n0...m2n2");
}

static conus_status read_comment(struct reading *reading, struct text line)
{
    struct text rest = {line.data + 1, line.size - 1};
    struct text value;
    rest = text_trim(rest);
    if (has_prefix(rest, "Coordinate system:", &value)) {
        return read_space(reading, value);
    }
    if (has_prefix(rest, "Units:", &value) || has_prefix(rest, "units:", &value)) {
        return text_starts(value, "millimetres") || text_starts(value, "millimeters") || text_starts(value, "mm")
                   ? CONUS_OK
                   : fail(CONUS_ERROR_DATA, "units \"%.*s\", millimetres are needed", POSE_QUOTE(value));
    }
    return memchr(rest.data, '\t', rest.size) ? begin_section(reading, rest) : CONUS_OK;
}

/* m0n0 m0n1 m0n2 is where the device's x points, and so on. */
static conus_status read_matrix(conus_pose *out, const struct reading *reading, const double position[3])
{
    double axes[9];
    conus_status status = named_cells_numbers(axes, &reading->cells, M00, 9);
    if (status) {
        return status;
    }
    double m[16] = {[15] = 1};
    for (int i = 0; i < 3; i++) {
        memcpy(m + 4 * i, axes + 3 * i, 3 * sizeof *m);
    }
    memcpy(m + 12, position, 3 * sizeof *m);
    return pose_of_matrix(out, m, reading->lps, reading->options->axis);
}

static conus_status read_pose(conus_pose_row *row, const struct reading *reading)
{
    double position[3];
    conus_status status = named_cells_numbers(position, &reading->cells, X, 3);
    row->time_s = pose_clock(named_cell(&reading->cells, DATE), named_cell(&reading->cells, CLOCK));
    if (status) {
        return status;
    }
    row->is_point = true;
    for (size_t i = M00; i <= M22; i++) {
        row->is_point = row->is_point && named_cell_is_absent(&reading->cells, i);
    }
    if (!row->is_point) {
        return read_matrix(&row->pose, reading, position);
    }
    if (reading->lps) {
        pose_flip_point(position);
    }
    return pose_of_point(&row->pose, position);
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

static conus_status read_row(struct reading *reading, struct text line)
{
    if (reading->kind == KINDS) {
        reading->passed_over++;
        return CONUS_OK;
    }
    if (reading->counting) {
        struct text field;
        for (bool more = true; text_field(&line, '\t', &more, &field);) {
            table_add_comma(&reading->cells.table, field);
        }
        reading->rows[reading->kind]++;
        return CONUS_OK;
    }
    if (!reading->has_space) {
        return fail(CONUS_ERROR_DATA, "a pose, but no coordinate system was named before");
    }
    char buffer[POSE_ID_LIMIT + 1];
    conus_pose_row row = pose_row_at(reading->line);
    conus_status bad = named_cells_split(&reading->cells, line);
    bad = bad ? bad : read_pose(&row, reading);
    struct text name = reading->cells.line.cells[0];
    return pose_list_add(reading->list, &row, full_name(buffer, reading, name), bad ? conus_message() : NULL);
}

static conus_status read_lines(struct reading *reading, struct text text)
{
    struct text line;
    char where[POSE_ORDINAL_SIZE + 8];
    conus_status status = CONUS_OK;
    reading->kind = KINDS;
    reading->passed_over = 0;
    for (reading->line = 1; text_line(&text, &line); reading->line++) {
        if (text_trim(line).size) {
            status = line.data[0] == '#' ? read_comment(reading, line) : read_row(reading, line);
        }
        if (status) {
            snprintf(where, sizeof where, "line %zu", reading->line);
            return fail_in(status, where);
        }
    }
    return CONUS_OK;
}

conus_status pose_brainsight_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options, .counting = true};
    reading.cells = (struct named_cells){
        .names = names,
        .count = COLUMNS,
        .needed = DATE,
        .may_be_longer = true,
        .table = {TABLE_TABS, .quotes_are_plain = true},
    };
    conus_status status = read_lines(&reading, text);
    reading.counting = false;
    reading.has_space = false;
    status = status ? status : read_lines(&reading, text);
    if (!status && !reading.has_section && reading.passed_over) {
        status =
            fail(CONUS_ERROR_DATA, "no header of a section with tabs between its columns, as Brainsight writes them: "
                                   "was it saved with commas or semicolons?");
    }
    if (!status && reading.passed_over) {
        status =
            notes_add(&list->notes, "%zu rows of landmarks and other sections were passed over", reading.passed_over);
    }
    return status ? status : pose_note_space(&list->notes, options, reading.lps);
}
