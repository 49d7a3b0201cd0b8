/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Regions of space, and what of rows of voxels, segments and triangles lies in one (Eq. 10, 19). */
#ifndef CONUS_SELECTION_REGION_REGION_H
#define CONUS_SELECTION_REGION_REGION_H

#include "atlas/tracts/tractogram.h"
#include "atlas/volume.h"
#include "selection/cone/cone.h"

/* A region of space that voxels can be in: a cone, a cylinder about the axis, a ball (Eq. 10). One predicate
 * decides; whatever finds voxels faster only keeps from asking it where the answer is certain. Every region is
 * convex. */

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

/* Several rows of a volume's voxels against a region, side by side: which voxels are in it beyond doubt, and which
 * may be. region_has() decides about those between. */

/** A line at + t step as a region sees it: numbers that are linear in t, [0] at t = 0 and [1] per t. It is in the
 * region where the length of `across` is not above the width, within the range of depths. */
struct region_line {
    double depth[2];
    double width[2];
    double across[2][3];
};

enum { REGION_ROWS = 64 };

/** First and last index along its axis, of each row; [0] above [1] where there is none. */
struct region_cut {
    uint64_t maybe[2][REGION_ROWS]; /**< Voxels that may be in the region: none beyond them is. */
    uint64_t sure[2][REGION_ROWS];  /**< Those among them that are.                             */
};

struct region_rows;

/** Cuts @p count rows from number @p j on, at most REGION_ROWS, to the indices @p limit[0] to @p limit[1]. */
typedef void region_rows_cutter(struct region_cut *out, const struct region_rows *rows, size_t j, size_t count,
                                const size_t limit[2]);

/** All rows of a slice. */
struct region_rows {
    region_rows_cutter *cut; /**< The fastest. */
    const struct region *region;
    const double *world_from_voxel;
    int across_slices;                      /**< The axis along which a slice comes after the other. */
    double margin;                          /**< mm: nearer to the region's border than that is doubt. */
    struct region_line row;                 /**< From the slice's first voxel along the rows, and      */
    struct region_line column;              /**< from row to row.                                      */
    double curve;                           /**< For the rows: width[1]^2 - |across[1]|^2.                  */
    double per_depth, per_width, per_curve; /**< 1 / row.depth[1], 1 / row.width[1], 1 / curve.            */
};

/** For the rows of @p volume along its axis @p axes[0], those along axes[1] being a slice; region_rows_place() must
 * follow. */
void region_rows_init(struct region_rows *out, const struct region *region, const struct volume *volume,
                      const int axes[3]);

/** Goes to slice @p k. */
void region_rows_place(struct region_rows *rows, size_t k);

/** Keeps of the rows @p range [0] to @p range [1] of the slice those that may have a voxel in the region: the others
 * have none. False where none may. */
bool region_rows_narrow(size_t range[2], const struct region_rows *rows);

/* By instruction set, all of them from region_rows_lanes.h, with the same bits. */
region_rows_cutter region_rows_cut_avx512, region_rows_cut_avx2, region_rows_cut_plain;

/** Kernel @p index among those that this machine can run, the fastest first; NULL past the last. */
region_rows_cutter *region_rows_kernel(size_t index);

/* The part of a segment that lies in a region, and whether a box lies in it (Eq. 19). Every region is convex, so
 * that one piece of a segment lies in it. */

/** The part from s = @p out [0] to @p out [1] of the segment from ends[0] (s = 0) to ends[1] (s = 1), world mm, that
 * lies in the region; false where none does. @p inside: what region_has() says of the two ends. The segment comes in
 * where region_has() says so of an end or of the middle of the part that is solved for. Where it comes in and out is
 * met within 1e-12 of the coordinates' size, in mm. */
bool region_segment(double out[2], const struct region *region, double ends[2][3], const bool inside[2]);

/** Cuts @p s to where the line @p v + s @p u, both from the region's origin, lies in it; false where that leaves
 * nothing.
 */
bool region_line(double s[2], const struct region *region, const double v[3], const double u[3]);

/** Where the box, its border included, lies. Outside: region_has() holds at none of its points, and no segment in it
 * comes in; inside: it holds at all of them. A box at the border may get TRACT_PERHAPS either way. */
enum tract_answer region_box(const struct region *region, const double low[3], const double high[3]);

/* The volume that a closed surface encloses in a region, as a sum over its triangles (Eq. 10). By the divergence
 * theorem a triangle counts with the flux of a field whose divergence is 1 and that runs along the region's side: (p
 * - apex) / 3 in a cone, (depth - near) axis in a cylinder. */

/** A region as triangles are cut to it; what `region` leads to must outlive it. */
struct region_solid {
    const struct region *region;
    struct region side; /**< The region without its range, in a frame of its own: up, right, axis from its origin. */
};

void region_solid_init(struct region_solid *out, const struct region *region);

/** The contribution of a triangle, in world mm, to a volume, mm^3. Its sum over the triangles of a closed surface is
 * the integral, over the region, of how often the surface winds around a point: the enclosed volume where that is 1
 * inside. Only triangles count that lie in the region or cross a plane that bounds its range; in a ball all do. Closed
 * forms, except arcs on a cone's side, which are met within 1e-10 of themselves. */
double region_triangle(const struct region_solid *solid, double corners[3][3]);

#endif
