/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A list as SVG, in which text stays text. */
#ifndef CONUS_RENDER_DRAW_SVG_H
#define CONUS_RENDER_DRAW_SVG_H

#include "base/buffer.h"
#include "render/draw/list.h"

/** Appends a file of the picture's pixels, a PNG, and the list over them, with a description of it (NULL or "" = none).
 * @p dpi: 0 = not known. */
conus_status draw_format_svg(struct buffer *out, const struct draw_list *list, const uint8_t *png, size_t png_size,
                             double dpi, const char *description);

#endif
