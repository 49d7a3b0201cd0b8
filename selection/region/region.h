/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A region of space that voxels can be in: a cone, a cylinder about the axis, a ball (Eq. 10). One predicate decides;
 * whatever finds voxels faster only keeps from asking it where the answer is certain. Every region is convex. */
#ifndef CONUS_SELECTION_MEASURE_REGION_H
#define CONUS_SELECTION_MEASURE_REGION_H

#include "atlas/volume.h"
#include "selection/cone/cone.h"

enum region_shape { REGION_CONE, REGION_CYLINDER, REGION_BALL };

struct region {
    enum region_shape shape;
    bool square; /**< A pyramid or a prism in place of a cone or a cylinder. */
    double origin[3];
    double right[3], up[3], axis[3]; /**< Unit vectors; of a ball none.                                     */
    double slope;                    /**< Cone: tan(angle/2).                                               */
    double sine, cosine;             /**< Cone: of angle/2; cylinder: 0 and 1.                                   */
    double radius;                   /**< Cylinder and ball, mm.                                            */
    double near, far;                /**< Depth along the axis in mm, 0 or more; infinite where there is none. */
};

/** The cone with its range, or the cylinder. */
void region_from_cone(struct region *out, const struct cone *cone);

/** A ball of @p radius > 0 mm. */
void region_ball(struct region *out, const double centre[3], double radius);

/** Whether the world point @p point is in the region, its border included (Eq. 10). */
bool region_has(const struct region *region, const double point[3]);

/** Between which indices along each axis a region's part in a grid lies. */
struct region_bounds {
    double depth[2]; /**< Range of the grid's voxels in the region, along the axis; of a ball (0, 0).             */
    double rim[2];   /**< Half-width at depth z: rim[0] + rim[1] z.                                         */
    struct {
        double centre[2]; /**< The axis at depth z is at centre[0] + centre[1] z;                           */
        double spread;    /**< the region reaches so much farther both ways, times its half-width.          */
    } along[3];
};

void region_bounds_init(struct region_bounds *out, const struct region *region, const struct volume *volume);

/** Cuts @p depth to where the plane of index @p index along @p axis meets the region; false where nothing is left. */
bool region_bounds_plane(double depth[2], const struct region_bounds *bounds, int axis, double index);

/** The first and last index along @p axis, of @p dim, of voxels at the depths @p depth; false where there is none. The
 * bounds are not tight, but hold whatever is rounded. */
bool region_bounds_range(size_t out[2], const struct region_bounds *bounds, int axis, const double depth[2],
                         size_t dim);

#endif
