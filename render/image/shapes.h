/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Lines, boxes and text that are kept beside an image's pixels in place of being drawn into them: for files in which
 * text stays text. Positions are pixels from the image's upper left corner, x before y. */
#ifndef CONUS_RENDER_IMAGE_SHAPES_H
#define CONUS_RENDER_IMAGE_SHAPES_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum shape_kind {
    SHAPE_LINE, /**< `from` to `to`, with round ends. */
    SHAPE_BOX,  /**< `from` is its upper left corner, `to` its lower right one; a frame inside it where it has a width.
                 */
    SHAPE_TEXT, /**< Its baseline begins at `from`. */
    SHAPE_LOOP, /**< A closed line through `points`. */
    SHAPE_PAIRS /**< Lines between the first and second of `points`, the third and fourth, and so on. */
};

struct image_shape {
    enum shape_kind kind;
    double from[2], to[2];
    double width;    /**< Width of a line; size of letters; 0 = a filled box. */
    double rounding; /**< Radius of a box's corners. */
    double length;   /**< How wide a text is. */
    float rgba[4];   /**< Linear, not premultiplied. */
    char *text;      /**< UTF-8. */
    double (*points)[2];
    size_t point_count;
};

struct shapes {
    struct image_shape *items;
    size_t count, capacity;
    bool failed;     /**< One found no memory. */
    char family[64]; /**< Family of the font. */
};

/** Appends a copy of @p shape, of its text and points, too. Without memory it fails like a buffer. */
void shapes_add(struct shapes *shapes, const struct image_shape *shape);

/** Moves all shapes of @p from to the end of @p to, each by @p by. */
void shapes_take(struct shapes *to, struct shapes *from, const double by[2]);

/** NULL is fine. */
void shapes_destroy(struct shapes *shapes);

#endif
