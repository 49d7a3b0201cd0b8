/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas in another space: moved by a deformation field. */
#ifndef CONUS_ATLAS_WARP_WARP_H
#define CONUS_ATLAS_WARP_WARP_H

#include "atlas/atlas.h"

/** How an atlas is warped. */
struct warp_plan {
    const char *words;             /**< The transform in one line, for notes. */
    const conus_volume_info *grid; /**< Voxels of the warped volumes: dim and place, in the space from which the
                                      transform takes points.                                                */
    uint64_t max_memory;           /**< Bytes that the resampled voxels may take; 0 = 8 GiB.                  */
};

#define WARP_AS_FINE 1.05 /**< Voxels of a grid that are longer than the atlas's by no more than this are as fine. */

/** Makes plan->grid where none is given, for atlas_warp(): the nodes of the last field, parted until voxels are as fine
 * as the atlas's smallest; voxels of that size in the region of a spline. A large grid is cut to what can come to the
 * atlas's voxels. CONUS_ERROR_DATA for one that has far more voxels than the atlas. */
conus_status warp_grid(conus_volume_info *out, const conus_atlas *atlas, const struct deformation *fields,
                       size_t count);

/** How many voxels of the atlas a voxel of a grid is long, along the axis where that is most; 0 without voxels. */
double warp_coarseness(const double atlas_from_voxel[16], const conus_atlas *atlas);

/** Moves volumes, surfaces and streamlines by @p count fields, which map points of the new space as atlas_move()'s
 * matrix does, the last one first: voxels of plan->grid take the atlas's voxel nearest to their centre's image through
 * all that has moved the atlas; vertices and points are found by deformation_find(). Left out are triangles with a
 * vertex that is not found, and whole streamlines with such a point. @p fields (measured) are taken over on success.
 * Unchanged on failure: CONUS_ERROR_DATA if nothing of the voxels, of a surface or of a tractogram is left;
 * CONUS_ERROR_ARGUMENT if something is hidden, or an attached atlas was warped before; CONUS_ERROR_MEMORY. */
conus_status atlas_warp(conus_atlas *atlas, struct deformation *fields, size_t count, const struct warp_plan *plan);

/** atlas_move(), and resamples the voxels that warps have moved on plan->grid. CONUS_ERROR_ARGUMENT if none has. */
conus_status atlas_move_onto(conus_atlas *atlas, const double atlas_from_world[16], const struct warp_plan *plan);

#endif
