/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A list beside or below a picture that names what its colours mean. */
#ifndef CONUS_RENDER_DRAW_LEGEND_H
#define CONUS_RENDER_DRAW_LEGEND_H

#include "render/draw/font.h"

enum { LEGEND_DETAILS = 3, LEGEND_BAR = 32, LEGEND_COLUMNS = 16, LEGEND_SUBTITLES = 2 };

struct legend_row {
    uint8_t rgb[3];           /**< sRGB of the chip.                                                            */
    const uint8_t (*ramp)[3]; /**< [LEGEND_BAR] sRGB of the chip from left to right in place of `rgb`; NULL = that. */
    bool plain;               /**< No chip, and grey letters: for what is no object.                            */
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

#endif
