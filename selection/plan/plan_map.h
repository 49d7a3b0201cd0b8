/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Bounds of how far points are from a structure, or from what is not the structure: a byte for each voxel. */
#ifndef CONUS_SELECTION_PLAN_PLAN_MAP_H
#define CONUS_SELECTION_PLAN_PLAN_MAP_H

#include "selection/measure/clearance.h"

struct plan_map;

/** Measures the voxels round the objects of @p has, of @p volume, which has some: how far their centres are from the
 * nearest cell of these objects; or, with @p outside, of others and of all that is beyond the grid. @p out is NULL
 * where the grid's axes are not perpendicular and where that would be too many voxels. CONUS_ERROR_MEMORY. */
conus_status plan_map_create(struct plan_map **out, const struct clearance_index *index, const conus_atlas *atlas,
                             const struct volume *volume, const uint32_t *has, bool outside);
/** NULL is fine. */
void plan_map_destroy(struct plan_map *map);

/** mm between which, exclusively, the distance of a point is, which is @p at in the volume's voxels; the second may be
 * infinite. */
void plan_map_bounds(double bounds[2], const struct plan_map *map, const double at[3]);

/** Whether all of the part of @p needle is farther than @p distance, mm: 1; or some of it nearer: -1. 0 where the map
 * does not tell. */
int plan_map_is_farther(const struct plan_map *map, const struct needle *needle, double distance);

/** mm of the part of @p needle that are in the objects of a map with outside, to 1e-6; -INFINITY where it stays a
 * voxel away from them, NaN where the map does not tell. */
double plan_map_inside(const struct plan_map *map, const struct needle *needle);

/** No fewer mm than there are of the needle's line between the depths @p from and @p to that are @p distance or more
 * away. */
double plan_map_most(const struct plan_map *map, const struct needle *needle, double from, double to, double distance);

#endif
