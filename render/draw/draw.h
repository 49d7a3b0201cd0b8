/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All of a picture that is not shaded: lines, text and legends as one list, and what writes it. */
#ifndef CONUS_RENDER_DRAW_DRAW_H
#define CONUS_RENDER_DRAW_DRAW_H

#include "base/memory.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All of a picture that is not shaded, as one list: lines, outlines, boxes and text, which are laid over its pixels in
 * this order. paint.c puts them into the pixels or writes them as PDF, svg.c as SVG. Coordinates are pixels from the
 * picture's upper left corner, x before y, y down: the first pixel covers 0..1. Colours are linear radiance and
 * opacity, not premultiplied. What lies outside the picture is cut off, and what has no finite place is left out.
 *
 * Adding never reports: a list that found no memory stays failed, and who paints or writes it says so. */

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

/* Text in pictures. Its font is part of the program, so that a picture is the same everywhere. */

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

/* A list beside or below a picture that names what its colours mean. */

enum { LEGEND_DETAILS = 3, LEGEND_BAR = 32, LEGEND_COLUMNS = 16, LEGEND_SUBTITLES = 2 };

struct legend_row {
    uint8_t rgb[3];           /**< sRGB of the chip.                                                            */
    const uint8_t (*ramp)[3]; /**< [LEGEND_BAR] sRGB of the chip from left to right in place of `rgb`; NULL = that. */
    bool plain;               /**< No chip, and grey letters: for what is no object.                            */
    bool bare;                /**< No chip. */
    bool heading;             /**< A heading: only its name, in grey. */
    bool written;             /**< Its name is in the picture: the row is for the legend in words only. */
    bool striped;             /**< Stripes of its colour on the chip. */
    bool mark;                /**< A mark of a bar in place of the chip. */
    const uint8_t (
        *bar)[3]; /**< [LEGEND_BAR] sRGB of the bar from the row above, which has a mark, too; NULL = none. */
    const char *name;
    const char *own; /**< For the legend in words: the object's own name, where that is another; NULL = it is `name`. */
    const char *detail[LEGEND_DETAILS]; /**< Right-aligned columns after the name; NULL = empty.      */
};

struct legend {
    const char *title;                      /**< NULL = none.                                            */
    const char *subtitle[LEGEND_SUBTITLES]; /**< Lines in grey below it; NULL = none.                */
    const char *header[LEGEND_DETAILS];     /**< Those of the detail columns; all NULL = no header. */
    const struct legend_row *rows;
    size_t count;
    size_t tail;      /**< The last rows, which are shown even if there is no space for all: a key. */
    size_t columns;   /**< Of rows, side by side, at most LEGEND_COLUMNS; the answer's order is down each. 0 = 1. */
    double at[2];     /**< Left and top of its margin, pixels; it reaches to the picture's right and lower edge. */
    const float *ink; /**< Linear colour and opacity of its letters. */
    double faint;     /**< How opaque letters are that say less; 0 = 0.87. */
    double size;      /**< Letters: pixels per em. */
};

/** Chooses the letters of a legend with all rows and whole names, and its columns, up to those that it has. @p limit is
 * the width and height available, pixels: a legend that needs more with letters of @p largest pixels per em gets
 * smaller ones, down to @p smallest. Gives in @p size what it takes with its margin, which may exceed the limit: its
 * height with all rows, its width with those that the height has room for. */
void legend_fit(double size[2], struct legend *legend, struct font *font, const double limit[2], double largest,
                double smallest);

/** How many rows the legend has room for in @p height pixels. */
size_t legend_capacity(const struct legend *legend, double height);

/** Appends it. Names that are too long end in an ellipsis, details that do not fit are left out from the last on, and
 * of too many rows the first are shown, a line "and N others", and the tail, if there is space for these. A picture
 * too small for one row stays as it is. */
void legend_draw(struct draw_list *list, struct font *font, const struct legend *legend);

/* The transfer curve of sRGB. */

/** The transfer curve of sRGB (IEC 61966-2-1), for values 0 to 1. */
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);

/** sRGB bytes of a linear colour. */
void srgb_bytes(uint8_t rgb[3], const float linear[3]);

/* A list into pixels, or as PDF, through cairo. CONUS_ERROR_UNSUPPORTED where that cannot be loaded. */

/** Lays the list over R, G, B, A of its picture, [height * width] each: linear, premultiplied. */
conus_status draw_paint(float *const plane[4], const struct draw_list *list);

/** Appends a page with the picture's pixels @p rgba, [height * width * 4] sRGB, and the list over them; it embeds the
 * letters that are used. @p dpi: 0 = not known. */
conus_status draw_format_pdf(struct buffer *out, const struct draw_list *list, const uint8_t *rgba, double dpi);

/* A list as SVG, in which text stays text. */

/** Appends a file of the picture's pixels, a PNG, and the list over them, with a description of it (NULL or "" = none).
 * @p dpi: 0 = not known. */
conus_status draw_format_svg(struct buffer *out, const struct draw_list *list, const uint8_t *png, size_t png_size,
                             double dpi, const char *description);

#endif
