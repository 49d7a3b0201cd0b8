/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Sizes of letters and of the space around them, for the window, figures and the page: sisters of the colours in
 * look.h. apps/web/pack.mjs reads those of the page. */
#ifndef CONUS_BASE_LOOK_SIZES_H
#define CONUS_BASE_LOOK_SIZES_H

enum look_size {
    /* The window, pixels at a scale of 1. */
    LOOK_TEXT = 17,
    LOOK_HEADING = 30,
    LOOK_ROUNDING = 4, /**< Of corners. */
    LOOK_PADDING_X = 12,
    LOOK_PADDING_Y = 6,
    LOOK_GAP_X = 6,
    LOOK_GAP_Y = 4,
    LOOK_BAR = 10,   /**< A bar that scrolls. */
    LOOK_CELL = 4,   /**< Between a table's columns, */
    LOOK_CELL_Y = 4, /**< and between a row and its line. */

    /* Figures. */
    LOOK_FIGURE_PART = 54,  /**< Where no dpi is known letters are as high as this part of the shorter side, */
    LOOK_FIGURE_LEAST = 11, /**< and have at least so many pixels. */

    /* The page, pixels of CSS. */
    LOOK_PAGE_TITLE = 22,
    LOOK_PAGE_TYPE = 15,
    LOOK_PAGE_TABLE = 14,
    LOOK_PAGE_SMALL = 13,
};

/** Letters of figures, points of a 72nd inch. */
#define LOOK_FIGURE_POINTS 7.0

#endif
