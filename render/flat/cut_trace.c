/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks around areas of pixels, and finds where the distance to a cone's wall is 0. */
#include "render/flat/cut.h"

#include "base/look.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { CELL = 2 }; /* pixels between the places where a cone's wall is looked for */

static const uint8_t cone_rgb[3] = {LOOK_RGB(LOOK_CONE)};
static const uint8_t cone_edge[3] = {LOOK_RGB(LOOK_APEX)};
static const double CONE_LINE = 1.6;
static const double CONE_EDGE = 3; /* under it: the line is seen on white, on the cone's inside and on areas */

/* Lines of surfaces around the areas. */
static const uint8_t around_rgb[3] = {LOOK_RGB(LOOK_AROUND)};

/* Pixels, and which of their upper sides were walked along. */
struct walk {
    const uint32_t *objects;
    size_t width, height;
    bool *walked;
    double (*points)[2];
    size_t count, capacity;
};

static uint32_t object_at(const struct walk *walk, long column, long row)
{
    bool inside = column >= 0 && row >= 0 && column < (long)walk->width && row < (long)walk->height;
    return inside ? walk->objects[walk->width * (size_t)row + (size_t)column] : 0;
}

static bool add_point(struct walk *walk, long column, long row)
{
    if (!memory_reserve(&walk->points, &walk->capacity, walk->count + 1, sizeof *walk->points)) {
        return false;
    }
    walk->points[walk->count][0] = (double)column + 0.5;
    walk->points[walk->count][1] = (double)row + 0.5;
    walk->count++;
    return true;
}

/* From the upper side of a pixel on, with the area on the right hand: ahead is the next pixel along the side, and
 * beyond it the one across it. Where two pixels touch by a corner only, the walk stays with its own. */
static bool walk_around(struct walk *walk, size_t first)
{
    static const long steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const uint32_t object = walk->objects[first];
    long at[2] = {(long)(first % walk->width), (long)(first / walk->width)};
    int side = 0;
    bool fits = true;
    walk->count = 0;
    do {
        const long *step = steps[side];
        const long *out = steps[(side + 3) % 4];
        if (side == 0) {
            walk->walked[walk->width * (size_t)at[1] + (size_t)at[0]] = true;
        }
        if (object_at(walk, at[0] + step[0], at[1] + step[1]) != object) {
            fits = add_point(walk, at[0], at[1]);
            side = (side + 1) % 4;
            continue;
        }
        at[0] += step[0];
        at[1] += step[1];
        if (object_at(walk, at[0] + out[0], at[1] + out[1]) == object) {
            fits = add_point(walk, at[0], at[1]);
            at[0] += out[0];
            at[1] += out[1];
            side = (side + 3) % 4;
        }
    } while (fits && !(side == 0 && walk->width * (size_t)at[1] + (size_t)at[0] == first));
    return fits;
}

conus_status cut_trace_areas(const struct cut_lines *lines, const uint32_t *objects, uint32_t width, uint32_t height,
                             const bool *skips)
{
    struct walk walk = {.objects = objects, .width = width, .height = height};
    size_t pixels = (size_t)width * height;
    walk.walked = memory_zeroed(pixels, sizeof *walk.walked);
    bool fits = walk.walked;
    for (size_t i = 0; i < pixels && fits; i++) {
        uint32_t object = objects[i];
        bool is_upper = object && (i < width || objects[i - width] != object);
        if (!is_upper || walk.walked[i] || (skips && skips[object])) {
            continue;
        }
        fits = walk_around(&walk, i);
        for (size_t k = 0; k < walk.count; k++) {
            walk.points[k][0] += lines->at[0];
            walk.points[k][1] += lines->at[1];
        }
        struct draw_item loop = {.kind = DRAW_LOOP, .width = lines->width, .points = walk.points, .count = walk.count};
        draw_colour(loop.rgba, lines->rgb ? lines->rgb[object] : lines->list[object - 1].rgb, 1);
        if (fits) {
            draw_item(lines->out, &loop);
        }
    }
    memory_free(walk.walked);
    memory_free(walk.points);
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Where the distance is 0 on the sides of a cell, between corners of different signs. */
static size_t cross_cell(double points[4][2], const double corner[2], const double distance[4])
{
    static const double offset[4][2] = {{0, 0}, {CELL, 0}, {CELL, CELL}, {0, CELL}};
    size_t count = 0;
    for (int k = 0; k < 4; k++) {
        int next = (k + 1) % 4;
        if ((distance[k] < 0) != (distance[next] < 0)) {
            double part = distance[k] / (distance[k] - distance[next]);
            for (int a = 0; a < 2; a++) {
                points[count][a] = corner[a] + offset[k][a] + part * (offset[next][a] - offset[k][a]);
            }
            count++;
        }
    }
    return count;
}

void cut_trace_cone(const struct cut_lines *to, const struct cut_place *place, const struct cut_cone *cone)
{
    struct cut_lines lines = {
        .out = to->out, .width = to->width, .at = {to->at[0], to->at[1]}, .limit = {INFINITY, INFINITY}};
    for (uint32_t row = 0; row + CELL <= place->height; row += CELL) {
        for (uint32_t column = 0; column + CELL <= place->width; column += CELL) {
            /* distances are from the middles of pixels */
            const double corner[2] = {column, row};
            const double x[2] = {column - 0.5, column + CELL - 0.5};
            const double y[2] = {row - 0.5, row + CELL - 0.5};
            double points[4][2];
            const double first = cut_cone_distance(place, cone, x[0], y[0]);
            if (fabs(first) > 2 * CELL) { /* than the cell is across */
                continue;
            }
            const double distance[4] = {first, cut_cone_distance(place, cone, x[1], y[0]),
                                        cut_cone_distance(place, cone, x[1], y[1]),
                                        cut_cone_distance(place, cone, x[0], y[1])};
            size_t count = cross_cell(points, corner, distance);
            for (size_t k = 0; k + 1 < count; k += 2) {
                cut_lines_add(&lines, points[k], points[k + 1], 0);
            }
        }
    }
    cut_lines_finish(&lines);
}

/* Object 0 is the cone. */
static void flush(struct cut_lines *lines)
{
    struct draw_item item = {.kind = DRAW_LINES, .width = lines->width, .points = lines->points, .count = lines->count};
    item.width *= lines->object ? 1 : CONE_LINE;
    const uint8_t *rgb = lines->object == CUT_AROUND ? around_rgb
                         : !lines->object            ? cone_rgb
                         : lines->rgb                ? lines->rgb[lines->object]
                                                     : lines->list[lines->object - 1].rgb;
    if (lines->count && !lines->object) {
        struct draw_item edge = item;
        edge.width = lines->width * CONE_EDGE;
        draw_colour(edge.rgba, cone_edge, 1);
        draw_item(lines->out, &edge);
    }
    draw_colour(item.rgba, rgb, 1);
    if (lines->count) {
        draw_item(lines->out, &item);
    }
    lines->count = 0;
}

void cut_lines_add(void *user, const double from[2], const double to[2], uint32_t object)
{
    struct cut_lines *lines = user;
    for (int a = 0; a < 2; a++) {
        if (fmin(from[a], to[a]) < 0 || fmax(from[a], to[a]) > lines->limit[a]) {
            return;
        }
    }
    if (object != lines->object) {
        flush(lines);
        lines->object = object;
    }
    if (!memory_reserve(&lines->points, &lines->capacity, lines->count + 2, sizeof *lines->points)) {
        lines->out->failed = true;
        return;
    }
    for (int a = 0; a < 2; a++) {
        lines->points[lines->count][a] = from[a] + lines->at[a];
        lines->points[lines->count + 1][a] = to[a] + lines->at[a];
    }
    lines->count += 2;
}

void cut_lines_finish(struct cut_lines *lines)
{
    flush(lines);
    memory_free(lines->points);
    lines->points = NULL;
}
