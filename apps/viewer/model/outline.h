/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Draws outlines around objects, in pictures of sRGB and opacity, [height width 4], top row first. */
#ifndef CONUS_VIEWER_MODEL_OUTLINE_H
#define CONUS_VIEWER_MODEL_OUTLINE_H

#include "viewer/model/viewer.h"

enum { OUTLINE_DASH = 8 /**< Pixels that a dash is long, and the gap behind it. */ };

/** A good place for the object's name: the middle of the upper edge of its outline. */
struct outline_top {
    bool is_there; /**< Something was outlined. */
    uint32_t x, y;
};

/** What has an outline; the later ones lie over the others. */
enum outline { OUTLINE_AVOIDED = 0, OUTLINE_TARGET /**< Of a plan. */, OUTLINE_CHOSEN, OUTLINE_COUNT };

struct outline_look {
    uint8_t rgb[3];
    double fill; /**< Opacity of the inside. */
};
extern const struct outline_look outline_looks[OUTLINE_COUNT];

/** The objects that have it, [objects + 1], to be freed; NULL: none has, or no memory. */
bool *outline_wanted(struct viewer *viewer, enum outline which);

/** The name of an object that has it; NULL: @p which is not of a plan. */
const char *outline_name(struct viewer *viewer, enum outline which);

/** Takes the stairs off a shape, @p mask, [height width] of 0 and 1: each pixel becomes what most are that are up to
 * @p reach beside it. A square stays that is wider than 1.42 @p reach + 1. @p level gets how many they are, of 255: the
 * edge is at a half. Unchanged without memory. */
void outline_smooth(uint8_t *mask, uint8_t *level, uint32_t width, uint32_t height, uint32_t reach);

/** Draws a line inside the edge of @p mask, [height width] of 0 and 1, and a dark one outside; none at the picture's
 * border. All else of a mask that is filled becomes so. */
void outline_draw(uint8_t *rgba, struct outline_top *top, const uint8_t *mask, uint32_t width, uint32_t height,
                  const struct outline_look *look);

/** Makes dashes of the outline of @p mask that was drawn, where @p hidden, [height width], is 1. */
void outline_dash(uint8_t *rgba, const uint8_t *mask, const uint8_t *hidden, uint32_t width, uint32_t height);

/** Takes the stairs off the lines that were drawn of a mask of this @p level, as far as dashes left them: pixels are
 * covered in part. Unchanged without memory. */
void outline_soften(uint8_t *rgba, const uint8_t *level, uint32_t width, uint32_t height,
                    const struct outline_look *look);

/** Draws a wider outline, of two pixels, around the @p wanted ones of @p objects, [height width], over @p rgba; none
 * without memory. */
void outline_cut(uint8_t *rgba, struct outline_top *top, const uint32_t *objects, uint32_t width, uint32_t height,
                 const bool *wanted, const struct outline_look *look);

#endif
