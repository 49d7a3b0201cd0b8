/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A structure for a plan: bounds of distances to it, and its inner point. */
#ifndef CONUS_SELECTION_PLAN_PLAN_DEEPEST_H
#define CONUS_SELECTION_PLAN_PLAN_DEEPEST_H

#include "selection/measure/measure.h"
#include "selection/plan/plan.h"

/* Bounds of distances to a structure, or to what is outside of it: a byte for each voxel. */

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

/* The inner point of a structure, how far it is, and how much of it lies on which side, hidden or not. */

/** A point of a structure. */
struct inner_point {
    double at[3];    /**< World mm. */
    double depth;    /**< mm to what is not the structure; 0 = there is no such point. */
    uint64_t source; /**< Linear index of its voxel; UINT64_MAX of a surface. */
};

/** Of the centres of the structure's voxels that which is farthest from the centres of all others, background and what
 * lies beyond the grid included; of the points inside of a closed surface, on a grid of 1 mm (or less, where none is
 * inside), that which is farthest from it. Of points that are equal to 1e-9 mm the nearest to @p centroid, then the
 * first. @p structure is one with hidden objects. CONUS_ERROR_MEMORY. */
conus_status plan_deepest(struct inner_point *out, const struct plan_constraint *structure, const double centroid[3]);

/** Whether a point lies in one of the structure's voxels or closed surfaces. */
bool plan_is_inside(const struct plan_constraint *structure, const double point[3]);

/** The centre of the structure's voxel, or the point of its surface, that is nearest to @p from, of equally near ones
 * the first; false for bundles, which have neither. */
bool plan_nearest_point(double out[3], const struct plan_constraint *structure, const double from[3]);

/** mm from each point to the nearest voxel's centre or point of a surface of its object and of those below it, hidden
 * or not; 0 in such a voxel, infinite where there is neither. @p out is [count]. One pass over the voxels for all
 * points. CONUS_ERROR_MEMORY. */
conus_status plan_distances(double *out, const conus_atlas *atlas, const uint32_t *objects, const double (*points)[3],
                            size_t count);

/** The structure's mean position, weighted by volume, and that volume, mm^3, in out[3]; all 0 without one. */
void plan_centroid(double out[4], const struct plan_constraint *structure);

/** Refuses the inner point of a structure of which 20 % or more lie on each side (frame_midline()), and whose object
 * says no side: nobody has chosen one. One that is nearer to the midline than half its depth is fine, in an atlas some
 * of whose areas have a side. Where the midline is not known, each without a side is refused. CONUS_ERROR_ARGUMENT
 * with both volumes and the way on; CONUS_ERROR_MEMORY. */
conus_status plan_check_sides(const struct plan_constraint *structure, const struct inner_point *inner,
                              const conus_atlas *atlas, uint32_t object);

#endif
