/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How the window is divided: panels left and right, and between them two columns and two rows of panes. */
#ifndef CONUS_VIEWER_WINDOW_LAYOUT_H
#define CONUS_VIEWER_WINDOW_LAYOUT_H

#include <stdbool.h>

/** The widths that the user left; all 0 = as at first. */
struct layout {
    double panels[2]; /**< Widths of the left and the right panel, pixels where texts have scale 1; 0 = as at first. */
    double division[2]; /**< Parts of the middle's width and height, 0.1 to 0.9, of the first column and the first row;
                             0 = a half. */
};

/** Pixels of a window. */
struct division {
    float left, right;   /**< Widths of the panels. */
    float columns, rows; /**< Width and height of the middle. */
    float column, row;   /**< Width of the first column and height of the first row. */
};

/** Divides a window so that the middle keeps a fifth of its width at least. */
struct division layout_divide(const struct layout *layout, float width, float height, float scale);

enum border { BORDER_LEFT, BORDER_RIGHT, BORDER_COLUMN, BORDER_ROW, BORDER_COUNT };

/** Moves a border to @p at, pixels from the window's left or upper edge. */
void layout_move(struct layout *layout, enum border border, float at, float width, float height, float scale);
/** Puts a border where it was at first. */
void layout_reset(struct layout *layout, enum border border);
/** Makes the first column and row larger by a step, or smaller (-1). */
void layout_widen_first(struct layout *layout, int steps);
/** Makes both panels wider by a step, or narrower (-1), of a window @p width pixels wide. */
void layout_widen_panels(struct layout *layout, int steps, float width, float scale);
bool layout_is_same(const struct layout *a, const struct layout *b);
/** Whether the numbers are ones that a layout can have. */
bool layout_is_fine(const struct layout *layout);

#endif
