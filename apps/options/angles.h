/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Angles from LOW to HIGH in steps, as --angles has them; in whatever unit. */
#ifndef CONUS_OPTIONS_ANGLES_H
#define CONUS_OPTIONS_ANGLES_H

#include <stddef.h>

enum { ANGLE_LIMIT = 1000 };

/** How many there are: LOW, LOW + STEP and so on up to HIGH, which counts even if rounding puts it a little beyond.
 * 0 unless HIGH is from LOW on and STEP above 0; ANGLE_LIMIT + 1 for more than that many. */
size_t angles_count(const double range[3]);
/** The angle at @p index. */
double angles_at(const double range[3], size_t index);

#endif
