/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A place as people write it: numbers, or words that need an atlas or a cap to become a point. */
#ifndef CONUS_POSES_ROWS_PLACE_H
#define CONUS_POSES_ROWS_PLACE_H

#include "base/numbers.h"
#include "base/status.h"

enum place_form {
    PLACE_NUMBERS,  /**< Three numbers. */
    PLACE_NAME,     /**< An area, or else a position. */
    PLACE_CENTROID, /**< centroid:AREA */
    PLACE_NEAR,     /**< near:AREA */
    PLACE_LABEL,    /**< index:17, the area with this label. */
    PLACE_CAP       /**< 1020:C3, a position by the user's word. */
};

/** A place, taken apart. It borrows from the text. */
struct place_words {
    enum place_form form;
    struct text name;       /**< What stands behind the prefix, or all of it; not empty. */
    struct numbers numbers; /**< PLACE_NUMBERS: as of numbers_read(). PLACE_NAME: why it is none, if it has three. */
    uint64_t label;         /**< PLACE_LABEL */
};

/** Takes a place apart. It knows no atlas. CONUS_ERROR_ARGUMENT for an empty one, one that is no text, and a label that
 * is no number. */
conus_status place_read(struct place_words *out, struct text text);

/** Why the text is no three numbers, where it has that many and is no name either. */
conus_status place_fail_numbers(const struct place_words *words);

#endif
