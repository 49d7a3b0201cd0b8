/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Bounds of distances to a structure, or to what is outside of it: a byte for each voxel. */
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

/** The limits, mm, between which, exclusively, lies the distance of the point @p at (the volume's voxels); the second
 * may be infinite. */
void plan_map_bounds(double bounds[2], const struct plan_map *map, const double at[3]);

/** 1 if the whole part of @p needle is farther than @p distance, mm; -1 if some of it is nearer; 0 where the map cannot
 * say. */
int plan_map_is_farther(const struct plan_map *map, const struct needle *needle, double distance);

/** mm of the part of @p needle inside the objects of a map with outside, to 1e-6. -INFINITY where it stays a voxel away
 * from them, NaN where the map cannot say. */
double plan_map_inside(const struct plan_map *map, const struct needle *needle);

/** An upper bound of the mm of the needle's line, between the depths @p from and @p to, that are @p distance or more
 * away. */
double plan_map_most(const struct plan_map *map, const struct needle *needle, double from, double to, double distance);

#endif
