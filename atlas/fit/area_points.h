/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Points that represent the areas of an atlas. */
#ifndef CONUS_ATLAS_FIT_AREA_POINTS_H
#define CONUS_ATLAS_FIT_AREA_POINTS_H

#include "atlas/atlas.h"

enum { AREA_POINTS = 1 << 17 }; /**< At most so many. */

struct area_points {
    double *at; /**< [count][3] World mm. */
    size_t count;
};

/** The centres of the areas' voxels, sampled evenly if there are more than AREA_POINTS; for an atlas of surfaces their
 * vertices. Hidden objects do not count. There may be none. */
conus_status area_points_make(struct area_points *out, const conus_atlas *atlas);
void area_points_finish(struct area_points *points);

/** The mean of the points; there is at least one. */
void area_points_centre(double out[3], const struct area_points *points);

#endif
