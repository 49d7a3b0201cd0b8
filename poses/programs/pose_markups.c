/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses 3D Slicer's JSON, and its lists of fiducials. */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"
#include "poses/rows/space_words.h"

#include <stdio.h>

/* One markup: a line, or a list of points. */
struct markup {
    conus_pose_list *list;
    const conus_pose_options *options;
    size_t number; /* in the file, from 1, which is the line of its rows */
    const json_t *json;
    struct text name;
    double scale; /* mm per unit */
    bool lps;
};

/* Absent keys have the schema's defaults. */
static conus_status read_space_and_units(struct markup *markup)
{
    const json_t *system = json_object_get(markup->json, "coordinateSystem");
    struct text space = system ? json_text_of(system) : text_from("LPS");
    markup->lps = text_equal(space, "LPS");
    if (!markup->lps && !text_equal(space, "RAS")) {
        return fail(CONUS_ERROR_DATA, "markups[%zu]: coordinateSystem \"%.*s\", allowed are LPS and RAS",
                    markup->number - 1, POSE_QUOTE(space));
    }
    const json_t *value = json_object_get(markup->json, "coordinateUnits");
    value = json_is_array(value) ? json_array_get(value, 0) : value;
    struct text units = value ? json_text_of(value) : text_from("mm");
    markup->scale = space_unit_mm(units);
    return markup->scale > 0
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "markups[%zu]: coordinateUnits \"%.*s\", allowed are um, mm, cm and m",
                      markup->number - 1, POSE_QUOTE(units));
}

static conus_status read_position(double out[3], const struct markup *markup, const json_t *point)
{
    const json_t *position = json_object_get(point, "position");
    struct text status = json_text_of(json_object_get(point, "positionStatus"));
    if (status.size && !text_equal(status, "defined")) {
        return fail(CONUS_ERROR_DATA, "positionStatus \"%.*s\": the point was not placed", POSE_QUOTE(status));
    }
    if (!json_numbers(out, 3, position)) {
        return fail(CONUS_ERROR_DATA, "position: three numbers are needed");
    }
    vec3_scale(out, out, markup->scale);
    if (markup->lps) {
        pose_flip_point(out);
    }
    return CONUS_OK;
}

static conus_status read_points(const struct markup *markup, const json_t *points)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < json_array_size(points); i++) {
        const json_t *point = json_array_get(points, i);
        double position[3];
        conus_status bad = read_position(position, markup, point);
        status = pose_list_add_point(markup->list, markup->number, position, false,
                                     json_text_of(json_object_get(point, "label")), bad);
    }
    return status;
}

/* From the first point to the second; -z points the other way, from the second. */
static conus_status line_pose(conus_pose_row *row, const struct markup *markup, const json_t *points)
{
    double ends[2][3];
    if (json_array_size(points) != 2) {
        return fail(CONUS_ERROR_DATA, "a line of %zu points, 2 are needed", json_array_size(points));
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 2; i++) {
        status = read_position(ends[i], markup, json_array_get(points, i));
    }
    bool back = markup->options->axis == CONUS_AXIS_MINUS_Z;
    return status ? status : pose_row_toward(row, ends[back], ends[!back], NULL);
}

static conus_status read_line(const struct markup *markup, const json_t *points)
{
    conus_axis axis = markup->options->axis;
    if (axis != CONUS_AXIS_OF_FORMAT && axis != CONUS_AXIS_PLUS_Z && axis != CONUS_AXIS_MINUS_Z) {
        return fail(CONUS_ERROR_DATA, "markups[%zu]: a line has axis +z or -z, not %s", markup->number - 1,
                    pose_axis_name(axis));
    }
    conus_pose_row row = pose_row_at(markup->number);
    conus_status bad = line_pose(&row, markup, points);
    struct text label = json_text_of(json_object_get(json_array_get(points, 0), "label"));
    return pose_list_add(markup->list, &row, markup->name.size ? markup->name : label, bad ? conus_message() : NULL);
}

static conus_status read_markup(struct markup *markup)
{
    struct text type = json_text_of(json_object_get(markup->json, "type"));
    const json_t *points = json_object_get(markup->json, "controlPoints");
    markup->name = json_text_of(json_object_get(markup->json, "name"));
    conus_status status = read_space_and_units(markup);
    status = status ? status : pose_note_space(&markup->list->notes, markup->options, markup->lps);
    if (status) {
        return status;
    }
    if (text_equal(type, "Fiducial") || text_equal(type, "Line")) {
        return (type.data[0] == 'F' ? read_points : read_line)(markup, points);
    }
    const conus_pose_row row = pose_row_at(markup->number);
    (void)fail(CONUS_ERROR_DATA, "a markup of type \"%.*s\", allowed are Line and Fiducial", POSE_QUOTE(type));
    return pose_list_add(markup->list, &row, markup->name, conus_message());
}

static conus_status refuse_json(const json_t *root)
{
    bool is_probe = text_equal(json_text_of(json_object_get(root, "specification")), "probeinterface");
    bool is_pinpoint = json_object_get(root, "atlasName");
    return fail(CONUS_ERROR_DATA, "%s",
                is_probe      ? "a probe of ProbeInterface says where contacts are on it, and not where it lies: its "
                                "poses are another file"
                : is_pinpoint ? "a scene of Pinpoint is not read: save the tips and angles of its probes as a table "
                                "(probe,AP,ML,DV,phi,theta)"
                              : "JSON of no known program: no list \"markups\" of 3D Slicer's, neither \"xyz_picks\" "
                                "nor \"channel_N\" of IBL's, and no names with three numbers each");
}

conus_status pose_json_find(conus_pose_format *out, struct text text)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    bool is_ibl = pose_ibl_is(root);
    bool is_list = pose_brackets_json(root) != BRACKETS_NONE;
    if (!status && !is_ibl && !is_list && !json_is_array(json_object_get(root, "markups"))) {
        status = refuse_json(root);
    }
    *out = is_ibl ? CONUS_POSE_FORMAT_IBL : is_list ? CONUS_POSE_FORMAT_LIST : CONUS_POSE_FORMAT_MARKUPS;
    json_decref(root);
    return status;
}

conus_status pose_markups_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    json_t *root = NULL;
    if (text.size && text.data[0] == '#') {
        return pose_fcsv_parse(list, text, options);
    }
    conus_status status = json_text_load(&root, text);
    const json_t *markups = json_object_get(root, "markups");
    if (!status && !json_is_array(markups)) {
        status = refuse_json(root);
    }
    bool fits = options->axis == CONUS_AXIS_OF_FORMAT; /* an axis is for lines */
    for (size_t i = 0; !fits && i < json_array_size(markups); i++) {
        fits = text_equal(json_text_of(json_object_get(json_array_get(markups, i), "type")), "Line");
    }
    if (!status && !fits) {
        status = fail(CONUS_ERROR_DATA, "no markup is a line, so that no axis (%s) can be chosen",
                      pose_axis_name(options->axis));
    }
    for (size_t i = 0; !status && i < json_array_size(markups); i++) {
        struct markup markup = {.list = list, .options = options, .number = i + 1, .json = json_array_get(markups, i)};
        status = read_markup(&markup);
    }
    json_decref(root);
    return status;
}

enum column { LABEL, X, Y, Z, COLUMNS };

static const char *const names[COLUMNS] = {"label", "x", "y", "z"};

/* The columns that Slicer assumes where a file does not name them; since 5 rows have two more than it names. */
static const char named[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";
static const char usual[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID,positionStatus,autoCreated";
enum { FIELDS_OF_5 = 16, STATUS = 14 };
static const char usual_once[] = "label,x,y,z,sel,vis"; /* in Slicer 3 */

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    struct named_cells cells;
    bool has_columns, has_space, lps;
    bool is_old; /* Slicer 3, which had RAS only */
};

bool pose_fcsv_line(struct text line)
{
    static const char *const heads[] = {"# Markups fiducial file", "# Fiducial List file", "# columns = id,x,y,z",
                                        "# columns = label,x,y,z"};
    bool found = false;
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        found = found || text_starts(line, heads[i]);
    }
    return found;
}

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

static conus_status read_columns(struct reading *reading, struct text value)
{
    conus_status status = named_cells_find(&reading->cells, text_equal(value, named) ? text_from(usual) : value);
    for (size_t i = X; !status && i <= Z; i++) {
        if (!named_cells_has(&reading->cells, i)) {
            status = fail(CONUS_ERROR_DATA, "columns: \"%.*s\", x, y and z are needed", POSE_QUOTE(value));
        }
    }
    reading->has_columns = true;
    return status;
}

static conus_status read_comment(struct reading *reading, struct text line)
{
    struct text value;
    reading->is_old = reading->is_old || text_starts(line, "# Fiducial List file");
    if (!take_key(&value, line, "CoordinateSystem")) {
        return take_key(&value, line, "columns") ? read_columns(reading, value) : CONUS_OK;
    }
    bool ras = text_equal(value, "RAS") || text_equal(value, "0");
    reading->lps = text_equal(value, "LPS") || text_equal(value, "1");
    reading->has_space = true;
    return ras || reading->lps
               ? pose_note_space(&reading->list->notes, reading->options, reading->lps)
               : fail(CONUS_ERROR_DATA, "CoordinateSystem \"%.*s\", allowed are RAS, LPS, 0 and 1", POSE_QUOTE(value));
}

/* Before the first point, or at the end. */
static conus_status end_head(struct reading *reading)
{
    const char *assumed = reading->is_old ? usual_once : usual;
    conus_status status = reading->has_columns ? CONUS_OK : read_columns(reading, text_from(assumed));
    if (status || reading->has_space) {
        return status;
    }
    reading->has_space = true;
    reading->lps = !reading->is_old && reading->options->space == CONUS_SPACE_LPS;
    return reading->is_old ? pose_note_space(&reading->list->notes, reading->options, false)
                           : notes_warn(&reading->list->notes, "no line CoordinateSystem; taken as %s",
                                        reading->lps ? "LPS" : "RAS");
}

/* A row of Slicer 5 has two fields more than the header names, or none: the first says whether the point was placed
 * (vtkMRMLMarkupsNode::PositionDefined). One more, or other two, are what decimal commas make. */
static conus_status check_status(const struct named_cells *cells)
{
    const size_t count = cells->line.count;
    struct text status = count == FIELDS_OF_5 ? cells->line.cells[STATUS] : (struct text){"", 0};
    uint64_t number;
    bool is_of_5 = text_to_uint(status, 9, &number);
    if (cells->width != FIELDS_OF_5 || (count <= STATUS && !is_of_5)) {
        return CONUS_OK;
    }
    return !is_of_5 ? fail(CONUS_ERROR_DATA, "%zu fields, the header has %d; decimals are written with a point", count,
                           STATUS)
           : number != 2
               ? fail(CONUS_ERROR_DATA, "position status \"%.*s\", not 2: the point was not placed", POSE_QUOTE(status))
               : CONUS_OK;
}

static conus_status read_point(struct reading *reading, struct text line, size_t number)
{
    double point[3];
    conus_status bad = named_cells_split(&reading->cells, line);
    bad = bad ? bad : check_status(&reading->cells);
    bad = bad ? bad : named_cells_numbers(point, &reading->cells, X, 3);
    return pose_list_add_point(reading->list, number, point, reading->lps, named_cell(&reading->cells, LABEL), bad);
}

conus_status pose_fcsv_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {
        .list = list,
        .options = options,
        .cells = {.names = names, .count = COLUMNS, .table.separator = TABLE_COMMAS},
    };
    struct text line;
    conus_status status = pose_no_axis(options, "fiducials");
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        if (text_has_only(line, ",\t\r ")) {
            continue;
        }
        if (line.data[0] == '#') {
            status = read_comment(&reading, line);
        } else {
            status = end_head(&reading);
            status = status ? status : read_point(&reading, line, number);
        }
    }
    return status ? status : end_head(&reading);
}
