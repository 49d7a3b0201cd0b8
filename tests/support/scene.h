/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Random small atlases and poses for tests of the engines. */
#ifndef CONUS_TESTS_SUPPORT_SCENE_H
#define CONUS_TESTS_SUPPORT_SCENE_H

#include "selection/engine/engine.h"

/** A grid of @p dim voxels placed by a random affine: oblique, flipped, anisotropic, sheared; its centre near 0. */
conus_volume_info scene_grid(uint64_t *state, const size_t dim[3]);

/** A grid of @p dim voxels where @p world_from_voxel says; NULL: 1 mm voxels, the first at the origin. */
conus_volume_info scene_plain_grid(const size_t dim[3], const double world_from_voxel[16]);

/** A parcellation of @p labels without a label table. End it with conus_atlas_destroy(). */
conus_atlas *scene_parcellation(const conus_volume_info *grid, const uint32_t *labels);

/** A parcellation of 1 to @p dim_limit voxels along each edge with random blobs and specks, and @p pathways scalar
 * volumes on grids of their own. End it with conus_atlas_destroy(). */
conus_atlas *scene_atlas(uint64_t *state, size_t dim_limit, int pathways);

/** Adds a context on a random grid of @p dim voxels, each of which blocks with probability @p share. */
void scene_add_blockers(conus_atlas *atlas, uint64_t *state, const size_t dim[3], double share);

/** A pose anywhere from within the atlas to far outside, looking roughly towards it; now and then along the grid's
 * axes, and from a point on cell faces, edges or corners. */
conus_pose scene_pose(uint64_t *state, const conus_atlas *atlas);

/** World position of the centre of the voxel with linear index @p voxel. */
void scene_voxel(double out[3], const struct volume *volume, size_t voxel);

/** A cone from such a pose, of 1 to 170 degrees and 1 to 64 pixels along an edge. */
struct cone scene_cone(uint64_t *state, const conus_atlas *atlas);

/** A pose in general position, within or near the atlas: no ray of its cones is along an axis or meets a cell's edge.
 */
conus_pose scene_generic_pose(uint64_t *state, const conus_atlas *atlas);

#endif
