/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Outlines of a cut as lines: of areas along their pixels, and of the cone. */
#ifndef CONUS_RENDER_FLAT_CUT_TRACE_H
#define CONUS_RENDER_FLAT_CUT_TRACE_H

#include "render/draw/list.h"
#include "render/flat/cut.h"

/** Lines of a cut on their way to the list; those of surfaces come from cut_view.line, one item for each object. */
struct cut_lines {
    struct draw_list *out;
    const conus_object *list;
    const uint8_t (*rgb)[3]; /**< [object count + 1] In place of those of `list`; NULL = these. */
    double width;            /**< Of lines, pixels; the cone's is wider. */
    double at[2], limit[2];  /**< The corner in the picture; width and height: what is beyond is left out. */
    uint32_t object;         /**< Object of `points`. */
    double (*points)[2];
    size_t count, capacity;
};

/** Adds a loop around each group of a number's pixels that touch by their sides, and around each hole in it: through
 * the middles of the outermost pixels. Numbers for which @p skips is true have none; NULL = none is skipped.
 * CONUS_ERROR_MEMORY. */
conus_status cut_trace_areas(const struct cut_lines *lines, const uint32_t *objects, uint32_t width, uint32_t height,
                             const bool *skips);

/** Adds the line of a cone or cylinder in the cut. */
void cut_trace_cone(const struct cut_lines *lines, const struct cut_place *place, const struct cut_cone *cone);

/** A cut_line; its user is a struct cut_lines. */
void cut_lines_add(void *user, const double from[2], const double to[2], uint32_t object);

/** Adds what is left, and frees. */
void cut_lines_finish(struct cut_lines *lines);

#endif
