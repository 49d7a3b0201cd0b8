/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * All of a picture that is not shaded, as one list: lines, outlines, boxes and text, which are laid over its pixels in
 * this order. paint.h puts them into the pixels or writes them as PDF, svg.h as SVG. Coordinates are pixels from the
 * picture's upper left corner, x before y, y down: the first pixel covers 0..1. Colours are linear radiance and
 * opacity, not premultiplied. What lies outside the picture is cut off, and what has no finite place is left out.
 *
 * Adding never reports: a list that found no memory stays failed, and who paints or writes it says so. */
#ifndef CONUS_RENDER_DRAW_LIST_H
#define CONUS_RENDER_DRAW_LIST_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum draw_kind {
    DRAW_LINES, /**< Lines between the first and second of `points`, the third and fourth, and so on; round ends. */
    DRAW_LOOP,  /**< A closed line through `points`, with sharp corners. */
    DRAW_AREA,  /**< Filled, within a closed line through `points`. */
    DRAW_BOX,   /**< `points` are its upper left and lower right corner; a frame inside it where it has a width. */
    DRAW_TEXT   /**< Its baseline begins at the one of `points`. */
};

struct draw_item {
    enum draw_kind kind;
    double width;    /**< Width of a line; size of letters, pixels per em; 0 = a filled box. */
    double rounding; /**< Radius of a box's corners. */
    double length;   /**< How wide a text is. */
    float rgba[4];
    char *text; /**< UTF-8. */
    double (*points)[2];
    size_t count; /**< Of points. */
};

struct draw_list {
    uint32_t width, height; /**< Of the picture. */
    struct draw_item *items;
    size_t count, capacity;
    bool failed; /**< Something found no memory. */
};

/** CONUS_ERROR_MEMORY. */
conus_status draw_list_create(struct draw_list **out, uint32_t width, uint32_t height);
/** NULL is fine. */
void draw_list_destroy(struct draw_list *list);

/** Linear colour of the sRGB bytes @p rgb with @p opacity. */
void draw_colour(float rgba[4], const uint8_t rgb[3], float opacity);

/** Appends a copy of @p item, of its text and points, too. */
void draw_item(struct draw_list *list, const struct draw_item *item);

/** A straight line with round ends: a disc where they are equal. */
void draw_line(struct draw_list *list, const double from[2], const double to[2], double width, const float rgba[4]);

struct draw_box {
    double left, top, right, bottom;
};

/** A filled box whose corners have the radius @p rounding. */
void draw_box(struct draw_list *list, const struct draw_box *box, double rounding, const float rgba[4]);
/** The box's outline, @p width pixels wide, inside the box. */
void draw_frame(struct draw_list *list, const struct draw_box *box, double rounding, double width, const float rgba[4]);

/** Moves all of @p from to the end of @p to, each by @p by. */
void draw_take(struct draw_list *to, struct draw_list *from, const double by[2]);

#endif
