/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses 3D Slicer's JSON. */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "poses/rows/pose_row.h"
#include "poses/rows/space_words.h"

#include <stdio.h>

/* One markup: a line, or a list of points. */
struct markup {
    conus_pose_list *list;
    const conus_pose_options *options;
    size_t number; /* in the file, from 1 */
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

/* The file has no lines that matter: a row has the number of its markup. */
static conus_status add_row(const struct markup *markup, const conus_pose_row *row, struct text id, conus_status bad)
{
    return pose_list_add(markup->list, row, id, bad ? conus_message() : NULL);
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
    return add_row(markup, &row, markup->name.size ? markup->name : label, bad);
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
    if (text_equal(type, "Fiducial")) {
        return read_points(markup, points);
    }
    if (text_equal(type, "Line")) {
        return read_line(markup, points);
    }
    const conus_pose_row row = pose_row_at(markup->number);
    return add_row(
        markup, &row, markup->name,
        fail(CONUS_ERROR_DATA, "a markup of type \"%.*s\", allowed are Line and Fiducial", POSE_QUOTE(type)));
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
