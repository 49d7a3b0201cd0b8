/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the names of points say of left and right, and on which side the points lie. */
#ifndef CONUS_POSES_ROWS_SIDES_H
#define CONUS_POSES_ROWS_SIDES_H

#include "base/notes.h"
#include "base/text.h"

enum { SIDES_SHAFTS = 64, SIDES_SHAFT_SIZE = 12 };

/** All 0: nothing was counted yet. */
struct sides {
    size_t left, right, left_on_right, right_on_left; /**< Points that a word calls so. */
    struct shaft {
        char letters[SIDES_SHAFT_SIZE]; /**< "LPH" of "LPH 1". */
        size_t contacts, wrong;         /**< Wrong: on the other side than its first letter says. */
    } shafts[SIDES_SHAFTS];
    size_t shaft_count;
    bool has_others; /**< Names that end with a number and begin otherwise, or more shafts than these. */
};

/** The side that a name states by a word of its own: -1 left, +1 right, 0 none. */
int sides_of_name(struct text name);

/** Counts a point that is called @p name, and so or by a column on @p side; @p x mm from the middle, and wrong where
 * that is more than @p edge on the other side. */
void sides_count(struct sides *sides, int side, struct text name, double x, double edge);

/** CONUS_ERROR_DATA where half of the points called left, or right, lie on the other side; @p why: what they may be. */
conus_status sides_check(const struct sides *sides, const char *why);

/** Warns of shafts of electrodes (LA1, LPH-2) whose contacts, three at least, all lie on the other side than the first
 * letter says. It says a side only where there is the same shaft of the other one (RPH), or where all names with a
 * number begin so: of both letters, or of three shafts. */
conus_status sides_warn_of_shafts(const struct sides *sides, struct notes *notes);

#endif
