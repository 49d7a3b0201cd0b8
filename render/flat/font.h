/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Text on pictures, in the sans-serif font of the system (fontconfig finds it, FreeType draws it). */
#ifndef CONUS_RENDER_FLAT_FONT_H
#define CONUS_RENDER_FLAT_FONT_H

#include "conus/image.h"
#include "render/image/image.h"

struct font;

/** CONUS_ERROR_UNSUPPORTED where no scalable font is installed: a picture without text is better than none then. */
conus_status font_create(struct font **out);
void font_destroy(struct font *font);

/** Width in pixels of @p text (UTF-8; other bytes become U+FFFD) at @p size pixels per em. */
double font_width(struct font *font, double size, const char *text);

/** Draws @p text from @p x on, its baseline at @p y (coordinates and colour as in draw.h). */
conus_status font_draw(struct font *font, conus_image *image, const double at[2], double size, const float rgba[4],
                       const char *text);

/** Copies @p text into @p out, ended with an ellipsis where it is wider than @p limit pixels or longer than
 * @p out_size bytes; "" where not even the ellipsis fits. */
void font_shorten(char *out, size_t out_size, struct font *font, double size, const char *text, double limit);

#endif
