/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What an axis passes, from inside (Eq. 17). */
#ifndef CONUS_SELECTION_STUDY_SEGMENTS_H
#define CONUS_SELECTION_STUDY_SEGMENTS_H

#include "selection/selection.h"

struct conus_segments {
    struct cone cone; /**< One ray, along the axis; with the selector's range. */
    conus_segment *rows;
    size_t count;
};

#endif
