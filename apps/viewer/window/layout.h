/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How the window is divided: panels left and right, each a narrow rail where it is folded, and between them the
 * 3-D pane beside a strip of the three cuts. */
#ifndef CONUS_VIEWER_WINDOW_LAYOUT_H
#define CONUS_VIEWER_WINDOW_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>

enum { LAYOUT_RAIL = 48 /**< Pixels at scale 1: width of a rail. */ };

/** Whether a panel is folded to its rail: at first the left one is where the window is narrow. */
enum fold { FOLD_AS_AT_FIRST = 0, FOLD_CLOSED, FOLD_OPEN, FOLD_COUNT };

/** The widths that the user left; all 0 = as at first. */
struct layout {
    enum fold folds[2]; /**< Folds of the left and the right panel. */
    double panels[2]; /**< Widths of the left and the right panel, pixels where texts have scale 1; 0 = as at first. */
    double division[2]; /**< Parts of the middle's width and height, 0.1 to 0.9, of the 3-D pane and the first cut; 0 =
                           0.72, a third. */
};

/** Pixels of a window. */
struct division {
    bool folded[2];      /**< Whether each panel is a rail. */
    float left, right;   /**< Widths of the panels. */
    float columns, rows; /**< Width and height of the middle. */
    float column, row;   /**< Width of the 3-D pane and height of the first cut. */
};

/** Divides a window so that the middle keeps a fifth of its width at least. */
struct division layout_divide(const struct layout *layout, float width, float height, float scale);

enum border { BORDER_LEFT, BORDER_RIGHT, BORDER_COLUMN, BORDER_ROW, BORDER_COUNT };

/** Moves a border to @p at, pixels from the window's left or upper edge. */
void layout_move(struct layout *layout, enum border border, float at, float width, float height, float scale);
/** Puts a border where it was at first. */
void layout_reset(struct layout *layout, enum border border);
/** Makes the 3-D pane wider by a step, or narrower (-1). */
void layout_widen_first(struct layout *layout, int steps);
/** Folds a panel (0 = left, 1 = right) to its rail, or opens it. */
void layout_fold(struct layout *layout, size_t side, bool fold);
/** Makes both panels wider by a step, or narrower (-1), of a window @p width pixels wide. */
void layout_widen_panels(struct layout *layout, int steps, float width, float scale);
bool layout_is_same(const struct layout *a, const struct layout *b);
/** Whether the numbers are ones that a layout can have. */
bool layout_is_fine(const struct layout *layout);

#endif
