/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas in another space: all of it moved by a deformation field. */
#ifndef CONUS_ATLAS_WARP_WARP_H
#define CONUS_ATLAS_WARP_WARP_H

#include "atlas/atlas.h"

/** How an atlas is warped. */
struct warp_plan {
    const char *words;             /**< In one line what moves it.                                          */
    const conus_volume_info *grid; /**< Voxels of the warped volumes: dim and place, in the space from which the
                                      transform takes points.                                                */
    uint64_t max_memory;           /**< Bytes that the resampled voxels may take; 0 = 8 GiB.                  */
};

/** Moves volumes, surfaces and streamlines to where @p field, which atlas_move()'s words hold for, has them: voxels of
 * plan->grid become what the atlas's own voxel nearest to where their centre goes is, through all that has moved the
 * atlas; vertices and points are found by deformation_find(). Triangles with a vertex that is found nowhere are left
 * out, and so are whole streamlines with such a point. @p field (measured) is taken over on success. Unchanged on
 * failure: CONUS_ERROR_DATA where nothing of the voxels, of a surface or of a tractogram is left; CONUS_ERROR_ARGUMENT
 * where something is hidden, or an attached atlas was warped before; CONUS_ERROR_MEMORY. */
conus_status atlas_warp(conus_atlas *atlas, struct deformation *field, const struct warp_plan *plan);

/** atlas_move(), and resamples the voxels that warps have moved on plan->grid. CONUS_ERROR_ARGUMENT where none has. */
conus_status atlas_move_onto(conus_atlas *atlas, const double atlas_from_world[16], const struct warp_plan *plan);

#endif
