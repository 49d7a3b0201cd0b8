/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A list into pixels, or as PDF, through cairo. CONUS_ERROR_UNSUPPORTED where that cannot be loaded. */
#ifndef CONUS_RENDER_DRAW_PAINT_H
#define CONUS_RENDER_DRAW_PAINT_H

#include "base/buffer.h"
#include "render/draw/list.h"

/** Lays the list over R, G, B, A of its picture, [height * width] each: linear, premultiplied. */
conus_status draw_paint(float *const plane[4], const struct draw_list *list);

/** Appends a page with the picture's pixels @p rgba, [height * width * 4] sRGB, and the list over them; it embeds the
 * letters that are used. @p dpi: 0 = not known. */
conus_status draw_format_pdf(struct buffer *out, const struct draw_list *list, const uint8_t *rgba, double dpi);

#endif
