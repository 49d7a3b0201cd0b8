/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Draws an outline around the chosen object, in pictures of sRGB and opacity, [height width 4], top row first. */
#ifndef CONUS_VIEWER_MODEL_OUTLINE_H
#define CONUS_VIEWER_MODEL_OUTLINE_H

#include "viewer/model/viewer.h"

enum { OUTLINE_DASH = 4 /**< Pixels that a dash is long, and the gap behind it. */ };

/** A good place for the object's name: the middle of the upper edge of its outline. */
struct outline_top {
    bool is_there; /**< Something was outlined. */
    uint32_t x, y;
};

/** Which objects are the chosen one or below it, [objects + 1], to be freed; NULL: none is chosen, or no memory. */
bool *outline_wanted(const struct viewer *viewer);

/** Draws a bright line inside the edge of @p mask, [height width] of 0 and 1, and a dark one outside; none at the
 * picture's border. */
void outline_draw(uint8_t *rgba, struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height);

/** Makes dashes of the outline of @p mask that was drawn, where @p hidden, [height width], is 1. */
void outline_dash(uint8_t *rgba, const uint8_t *mask, const uint8_t *hidden, uint32_t width, uint32_t height);

/** A wider outline, two pixels bright, of the @p wanted ones of @p objects, [height width], in a copy of @p rgba that
 * is to be freed; NULL without memory. */
uint8_t *outline_cut(struct outline_top *top, const uint8_t *rgba, const uint32_t *objects, uint32_t width,
                     uint32_t height, const bool *wanted);

#endif
