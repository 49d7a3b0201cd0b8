/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Anti-aliased shapes laid over an image's R, G, B, A. Coordinates are pixels from the image's top left corner, y down:
 * the first pixel covers 0..1. Colours are linear radiance and opacity, not premultiplied. What lies outside is cut
 * off; an image without R, G, B, A is left alone. */
#ifndef CONUS_RENDER_FLAT_DRAW_H
#define CONUS_RENDER_FLAT_DRAW_H

#include "conus/image.h"
#include "render/image/image.h"

/** Linear colour of the sRGB bytes @p rgb with @p opacity. */
void draw_colour(float rgba[4], const uint8_t rgb[3], float opacity);

/** Blends @p rgba, scaled by @p coverage (0 to 1), over pixel number @p pixel; all four planes must be there. */
void draw_over(const struct image_rgba *planes, size_t pixel, const float rgba[4], float coverage);

/** A straight line with round ends: a disc where they are equal. */
void draw_line(conus_image *image, const double from[2], const double to[2], double width, const float rgba[4]);

struct draw_box {
    double left, top, right, bottom;
};

/** A filled box whose corners have the radius @p rounding. */
void draw_box(conus_image *image, const struct draw_box *box, double rounding, const float rgba[4]);
/** The box's outline, @p width pixels wide, inside the box. */
void draw_frame(conus_image *image, const struct draw_box *box, double rounding, double width, const float rgba[4]);

#endif
