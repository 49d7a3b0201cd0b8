/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Answers under errors of the pose, from inside (Eq. 14). */
#ifndef CONUS_SELECTION_STUDY_JITTER_H
#define CONUS_SELECTION_STUDY_JITTER_H

#include "selection/selection.h"

/** Errors have five dimensions; samples are counted in so many sets, one after the other. */
enum { JITTER_DIMENSIONS = 5, JITTER_SETS = 16 };

struct conus_jitter {
    conus_jitter_options options; /**< Defaults filled in. */
    struct cone cone;             /**< Without an error.   */
    conus_chance *rows;
    size_t count;
};

/** Standard normal errors of sample @p index: tilts about the device's x and y, shifts along x, y and z. */
void jitter_sample(double out[JITTER_DIMENSIONS], uint32_t index);

/** The pose with these errors, times the options' standard deviations. */
void jitter_pose(conus_pose *out, const conus_pose *pose, const conus_jitter_options *options,
                 const double errors[JITTER_DIMENSIONS]);

#endif
