/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The ray and the capsule of Eq. 18: all points that are no farther than a radius from a segment. */
#ifndef CONUS_ATLAS_TRACTS_CAPSULE_H
#define CONUS_ATLAS_TRACTS_CAPSULE_H

#include <stdbool.h>

/** Where the line through @p origin along @p direction (unit length) enters the capsule round the segment from @p a to
 * @p b and where it leaves it, mm from the origin; negative values are behind it. False (@p out untouched) where the
 * line misses it. A segment of one point is a ball. The radius is above 0. The same bits on every processor. */
bool capsule_interval(double out[2], const double origin[3], const double direction[3], const double a[3],
                      const double b[3], double radius);

#endif
