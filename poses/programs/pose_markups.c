/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses 3D Slicer's JSON, and its lists of fiducials. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"

/* One markup: a line, or a list of points. */
struct markup {
    struct job *job;
    struct pose_reading *to;
    size_t number; /* in the file, from 1, which is the line of its rows */
    const json_t *json;
    struct text name;
    double scale; /* mm per unit */
    bool lps;
};

/* Absent keys have the schema's defaults. */
static void read_space_and_units(struct markup *markup)
{
    const json_t *system = json_object_get(markup->json, "coordinateSystem");
    struct text space = system ? json_text_of(system) : text_from("LPS");
    markup->lps = text_equal(space, "LPS");
    if (!markup->lps && !text_equal(space, "RAS")) {
        job_bad(markup->job, "coordinateSystem \"%.*s\", allowed are LPS and RAS", POSE_QUOTE(space));
    }
    const json_t *value = json_object_get(markup->json, "coordinateUnits");
    value = json_is_array(value) ? json_array_get(value, 0) : value;
    struct text units = value ? json_text_of(value) : text_from("mm");
    markup->scale = space_unit_mm(units);
    if (!(markup->scale > 0)) {
        job_bad(markup->job, "coordinateUnits \"%.*s\", allowed are um, mm, cm and m", POSE_QUOTE(units));
    }
}

static void read_position(double out[3], const struct markup *markup, const json_t *point)
{
    const json_t *position = json_object_get(point, "position");
    struct text status = json_text_of(json_object_get(point, "positionStatus"));
    if (status.size && !text_equal(status, "defined")) {
        job_bad(markup->job, "positionStatus \"%.*s\": the point was not placed", POSE_QUOTE(status));
    } else if (!json_numbers(out, 3, position)) {
        job_bad(markup->job, "position: three numbers are needed");
    } else {
        vec3_scale(out, out, markup->scale);
        if (markup->lps) {
            pose_flip_point(out);
        }
    }
}

static void read_points(const struct markup *markup, const json_t *points)
{
    for (size_t i = 0; job_ok(markup->job) && i < json_array_size(points); i++) {
        const json_t *point = json_array_get(points, i);
        double position[3] = {0};
        const struct attempt attempt = job_try(markup->job);
        read_position(position, markup, point);
        pose_add_point(markup->to, markup->number, position, false, json_text_of(json_object_get(point, "label")),
                       attempt_end(markup->job, &attempt, ATTEMPT_TRY));
    }
}

/* From the first point to the second; -z points the other way, from the second. */
static void line_pose(conus_pose_row *row, const struct markup *markup, const json_t *points)
{
    double ends[2][3];
    bool back = markup->to->options->axis == CONUS_AXIS_MINUS_Z;
    if (json_array_size(points) != 2) {
        job_bad(markup->job, "a line of %zu points, 2 are needed", json_array_size(points));
    }
    for (size_t i = 0; job_ok(markup->job) && i < 2; i++) {
        read_position(ends[i], markup, json_array_get(points, i));
    }
    (void)JOB_CALL(markup->job, pose_row_toward(row, ends[back], ends[!back], NULL));
}

static void read_line(const struct markup *markup, const json_t *points)
{
    conus_axis axis = markup->to->options->axis;
    if (axis != CONUS_AXIS_OF_FORMAT && axis != CONUS_AXIS_PLUS_Z && axis != CONUS_AXIS_MINUS_Z) {
        job_bad(markup->job, "a line has axis +z or -z, not %s", pose_axis_name(axis));
    }
    conus_pose_row row = pose_row_at(markup->number);
    const struct attempt attempt = job_try(markup->job);
    line_pose(&row, markup, points);
    struct text label = json_text_of(json_object_get(json_array_get(points, 0), "label"));
    pose_add(markup->to, &row, markup->name.size ? markup->name : label,
             attempt_end(markup->job, &attempt, ATTEMPT_TRY));
}

static void read_markup(struct markup *markup)
{
    struct text type = json_text_of(json_object_get(markup->json, "type"));
    const json_t *points = json_object_get(markup->json, "controlPoints");
    markup->name = json_text_of(json_object_get(markup->json, "name"));
    read_space_and_units(markup);
    pose_note_space(markup->to->job, markup->to->options, markup->lps);
    if (text_equal(type, "Fiducial") || text_equal(type, "Line")) {
        (type.data[0] == 'F' ? read_points : read_line)(markup, points);
    } else {
        const conus_pose_row row = pose_row_at(markup->number);
        pose_add(markup->to, &row, markup->name,
                 job_format(markup->job, "a markup of type \"%.*s\", allowed are Line and Fiducial", POSE_QUOTE(type)));
    }
}

static void refuse_json(struct job *job, const json_t *root)
{
    bool is_probe = text_equal(json_text_of(json_object_get(root, "specification")), "probeinterface");
    bool is_pinpoint = json_object_get(root, "atlasName");
    job_bad(job, "%s",
            is_probe      ? "a probe of ProbeInterface says where contacts are on it, and not where it lies: its "
                            "poses are another file"
            : is_pinpoint ? "a scene of Pinpoint is not read: save the tips and angles of its probes as a table "
                            "(probe,AP,ML,DV,phi,theta)"
                          : "JSON of no known program: no list \"markups\" of 3D Slicer's, neither \"xyz_picks\" "
                            "nor \"channel_N\" of IBL's, and no names with three numbers each");
}

enum pose_format pose_json_find(struct pose_reading *to, struct text text)
{
    json_t *root = pose_json(to, text);
    bool is_ibl = pose_ibl_is(root);
    bool is_list = pose_brackets_json(root) != BRACKETS_NONE;
    if (!is_ibl && !is_list && !json_is_array(json_object_get(root, "markups"))) {
        refuse_json(to->job, root);
    }
    return is_ibl ? POSE_FORMAT_IBL : is_list ? POSE_FORMAT_LIST : POSE_FORMAT_MARKUPS;
}

/* 3D Slicer's markups: .mrk.json, lines and points, or .fcsv, points. */
void pose_markups_parse(struct pose_reading *to, struct text text)
{
    if (text.size && text.data[0] == '#') {
        pose_fcsv_parse(to, text);
        return;
    }
    struct job *job = to->job;
    const json_t *root = pose_json(to, text);
    const json_t *markups = json_object_get(root, "markups");
    if (!json_is_array(markups)) {
        refuse_json(job, root);
    }
    bool fits = to->options->axis == CONUS_AXIS_OF_FORMAT; /* an axis is for lines */
    for (size_t i = 0; !fits && i < json_array_size(markups); i++) {
        fits = text_equal(json_text_of(json_object_get(json_array_get(markups, i), "type")), "Line");
    }
    if (!fits) {
        job_bad(job, "no markup is a line, so that no axis (%s) can be chosen", pose_axis_name(to->options->axis));
    }
    for (size_t i = 0; job_ok(job) && i < json_array_size(markups); i++) {
        const size_t mark = job_in(job, "markups", i);
        read_markup(&(struct markup){.job = job, .to = to, .number = i + 1, .json = json_array_get(markups, i)});
        job_out(job, mark);
    }
}

enum column { LABEL, X, Y, Z, COLUMNS };

static const char *const names[COLUMNS] = {"label", "x", "y", "z"};

/* The columns that Slicer assumes where a file does not name them; since 5 rows have two more than it names. */
static const char named[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";
static const char usual[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID,positionStatus,autoCreated";
enum { FIELDS_OF_5 = 16, STATUS = 14 };
static const char usual_once[] = "label,x,y,z,sel,vis"; /* in Slicer 3 */

struct reading {
    struct job *job;
    struct pose_reading *to;
    struct named_cells cells;
    bool has_columns, has_space, lps;
    bool is_old; /* Slicer 3, which had RAS only */
};

/* "# KEY = value"; false for another comment. */
static bool take_key(struct text *value, struct text line, const char *key)
{
    struct text name;
    bool more = true;
    line = text_trim((struct text){line.data + 1, line.size - 1});
    if (!text_field(&line, '=', &more, &name) || !more || !text_equal(text_trim(name), key)) {
        return false;
    }
    *value = text_trim(line);
    return true;
}

static void read_columns(struct reading *reading, struct text value)
{
    named_cells_find(reading->job, &reading->cells, text_equal(value, named) ? text_from(usual) : value);
    for (size_t i = X; i <= Z; i++) {
        if (!named_cells_has(&reading->cells, i)) {
            job_bad(reading->job, "columns: \"%.*s\", x, y and z are needed", POSE_QUOTE(value));
        }
    }
    reading->has_columns = true;
}

static void read_comment(struct reading *reading, struct text line)
{
    struct text value;
    reading->is_old = reading->is_old || text_starts(line, "# Fiducial List file");
    if (take_key(&value, line, "columns")) {
        read_columns(reading, value);
    } else if (take_key(&value, line, "CoordinateSystem")) {
        bool ras = text_equal(value, "RAS") || text_equal(value, "0");
        reading->lps = text_equal(value, "LPS") || text_equal(value, "1");
        reading->has_space = true;
        if (!ras && !reading->lps) {
            bool is_ijk = text_equal(value, "IJK") || text_equal(value, "2");
            job_bad(reading->job, "CoordinateSystem \"%.*s\"%s", POSE_QUOTE(value),
                    is_ijk ? ": voxels, not mm: save it again in RAS or LPS; another number here converts nothing"
                           : ", allowed are RAS, LPS, 0 and 1");
        }
        pose_note_space(reading->to->job, reading->to->options, reading->lps);
    }
}

/* Before the first point, or at the end. */
static void end_head(struct reading *reading)
{
    if (!reading->has_columns) {
        read_columns(reading, text_from(reading->is_old ? usual_once : usual));
    }
    if (reading->has_space) {
        return;
    }
    reading->has_space = true;
    reading->lps = !reading->is_old && reading->to->options->space == CONUS_SPACE_LPS;
    if (reading->is_old) {
        pose_note_space(reading->to->job, reading->to->options, false);
    } else {
        job_warn(reading->job, "no line CoordinateSystem; taken as %s", reading->lps ? "LPS" : "RAS");
    }
}

/* A row of Slicer 5 has two fields more than the header names, or none: the first says whether the point was placed
 * (vtkMRMLMarkupsNode::PositionDefined). One more, or other two, are what decimal commas make. */
static void check_status(struct job *job, const struct named_cells *cells)
{
    const size_t count = cells->line.count;
    struct text status = count == FIELDS_OF_5 ? cells->line.cells[STATUS] : (struct text){"", 0};
    uint64_t number;
    bool is_of_5 = text_to_uint(status, 9, &number);
    if (cells->width != FIELDS_OF_5 || (count <= STATUS && !is_of_5)) {
        return;
    }
    if (!is_of_5) {
        job_bad(job, "%zu fields, the header has %d; decimals are written with a point", count, STATUS);
    } else if (number != 2) {
        job_bad(job, "position status \"%.*s\", not 2: the point was not placed", POSE_QUOTE(status));
    }
}

static void read_point(struct reading *reading, struct text line, size_t number)
{
    double point[3] = {0};
    const struct attempt attempt = job_try(reading->job);
    named_cells_split(reading->job, &reading->cells, line);
    check_status(reading->job, &reading->cells);
    named_cells_numbers(reading->job, point, &reading->cells, X, 3);
    pose_add_point(reading->to, number, point, reading->lps, named_cell(&reading->cells, LABEL),
                   attempt_end(reading->job, &attempt, ATTEMPT_TRY));
}

void pose_fcsv_parse(struct pose_reading *to, struct text text)
{
    struct reading reading = {
        .job = to->job,
        .to = to,
        .cells = {.names = names, .count = COLUMNS, .table.separator = TABLE_COMMAS},
    };
    struct text line;
    pose_refuse_axis(to, "fiducials");
    for (size_t number = 1; job_ok(to->job) && text_line(&text, &line); number++) {
        if (text_has_only(line, ",\t\r ")) {
            continue;
        }
        if (line.data[0] == '#') {
            read_comment(&reading, line);
        } else {
            end_head(&reading);
            read_point(&reading, line, number);
        }
    }
    end_head(&reading);
}
