/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A panel in a corner of a picture that names what its colours mean. */
#ifndef CONUS_RENDER_DRAW_LEGEND_H
#define CONUS_RENDER_DRAW_LEGEND_H

#include "render/draw/font.h"

enum { LEGEND_DETAILS = 3, LEGEND_BAR = 32 };

struct legend_row {
    uint8_t rgb[3]; /**< sRGB of the chip.                                                            */
    bool hollow;    /**< Only the chip's outline: for what is no object.                              */
    bool heading;   /**< A heading: only its name, in grey. */
    bool striped;   /**< Stripes of its colour on the chip. */
    bool mark;      /**< A mark of a bar in place of the chip. */
    const uint8_t (
        *bar)[3]; /**< [LEGEND_BAR] sRGB of the bar from the row above, which has a mark, too; NULL = none. */
    const char *name;
    const char *detail[LEGEND_DETAILS]; /**< Right-aligned columns after the name; NULL = empty.      */
};

/** Bit 0: on the right, bit 1: below. */
enum legend_corner { LEGEND_TOP_LEFT = 0, LEGEND_TOP_RIGHT, LEGEND_BOTTOM_LEFT, LEGEND_BOTTOM_RIGHT };

struct legend {
    const char *title;                  /**< NULL = none.                                            */
    const char *subtitle;               /**< In grey below it; NULL = none.                          */
    const char *header[LEGEND_DETAILS]; /**< Those of the detail columns; all NULL = no header. */
    const struct legend_row *rows;
    size_t count;
    size_t tail; /**< The last rows, which are shown even if there is no space for all: a key. */
    enum legend_corner corner;
    const double *at; /**< Left and top, pixels, in place of a corner; NULL = the corner.                           */
    const float *ink; /**< Linear colour and opacity of its letters where it has no panel; NULL = a dark panel.     */
    double faint;     /**< With ink: how opaque letters are that say less; 0 = 0.87.                        */
    double widest;    /**< The part of the picture's width that it may take, with its margin; 0 = 0.42.              */
    double size;      /**< Letters: pixels per em; 0 = a 54th of the picture's shorter side, at least 11.           */
};

/** Size of letters in a legend of default size on @p list, for other text to match. */
double legend_size(const struct draw_list *list);

/** Measures a legend with all rows, whole names and its margins. @p limit is the width and height available, pixels: a
 * legend that needs more with letters of @p largest pixels per em gets smaller ones, down to @p smallest. Returns their
 * size, and in @p size the legend's, which may exceed the limit. */
double legend_fit(double size[2], struct font *font, const struct legend *legend, const double limit[2], double largest,
                  double smallest);

/** How many rows a legend has room for in @p height pixels with letters of @p size pixels per em. */
size_t legend_capacity(const struct legend *legend, double size, double height);

/** Appends the panel. It keeps within `widest` and the picture's height: names that are too long
 * end in an ellipsis, columns that do not fit are left out from the last on, and of too many rows the first are shown,
 * a line "... and N more", and the tail, if there is space for these. A picture too small for one row stays as it is.
 */
void legend_draw(struct draw_list *list, struct font *font, const struct legend *legend);

#endif
