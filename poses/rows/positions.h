/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Positions of the 10-10 system and landmarks on the scalp of the MNI template, facts with their source. */
#ifndef CONUS_POSES_ROWS_POSITIONS_H
#define CONUS_POSES_ROWS_POSITIONS_H

#include "base/text.h"

/** One position on the scalp. */
struct position {
    const char *name;  /**< "C3". */
    const char *also;  /**< Its older name, "T3" of T7; NULL = none. */
    double point[3];   /**< MNI 152, RAS, mm. */
    double outward[3]; /**< Unit vector; all 0 where none is known. */
};

/** Position @p index, from 0; NULL past the last. Static. */
const struct position *position_at(size_t index);

/** The position called @p name, by its older name, too, in any case; NULL if there is none. Static. */
const struct position *position_find(struct text name);

#endif
