/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A sweep over the angle, from inside (Eq. 13). */
#ifndef CONUS_SELECTION_STUDY_SWEEP_H
#define CONUS_SELECTION_STUDY_SWEEP_H

#include "selection/selection.h"

struct conus_sweep {
    const conus_atlas *atlas;
    struct cone cone; /**< The widest. */
    conus_admission *rows;
    size_t count;
};

#endif
