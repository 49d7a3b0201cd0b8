/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Text in pictures. Its font is part of the program, so that a picture is the same everywhere. */
#ifndef CONUS_RENDER_DRAW_FONT_H
#define CONUS_RENDER_DRAW_FONT_H

#include "render/draw/list.h"

struct font;
struct _cairo; /* a cairo_t */

/** The font file, Liberation Sans (cmake/embed.cmake), which has the widths of Arial; packed by gzip. */
extern const unsigned char font_sans[];
extern const size_t font_sans_size;

/** CONUS_ERROR_UNSUPPORTED where cairo or FreeType cannot be loaded: a picture without text is better than none then.
 */
conus_status font_create(struct font **out);
void font_destroy(struct font *font);

/** Width in pixels of @p text (UTF-8; other bytes are taken as Windows-1252) at @p size pixels per em; 0 without
 * memory. */
double font_width(struct font *font, double size, const char *text);

/** Copies @p text into @p out, ended with an ellipsis where it is wider than @p limit pixels or longer than
 * @p out_size bytes; "" where not even the ellipsis fits. */
void font_shorten(char *out, size_t out_size, struct font *font, double size, const char *text, double limit);

/** Appends @p text, which begins at @p at on its baseline. */
void draw_text(struct draw_list *list, struct font *font, const double at[2], double size, const float rgba[4],
               const char *text);

/** Takes it for the text that cairo draws in the context @p to. @p in_pixels: heights snap to these, widths do not. */
void font_select(const struct font *font, struct _cairo *to, bool in_pixels);

#endif
