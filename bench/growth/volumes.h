/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Atlases of any number of voxels, or of labels, made in memory. */
#ifndef CONUS_BENCH_GROWTH_VOLUMES_H
#define CONUS_BENCH_GROWTH_VOLUMES_H

#include "atlas/atlas.h"

/** The parcellation of @p atlas with @p times as many voxels along each axis, by nearest neighbour, in the same place.
 * Two bytes a voxel beside the atlas. */
conus_status volumes_enlarge(conus_atlas **out, const conus_atlas *atlas, double times);

/** A ball in a cube of @p edge voxels of 1 mm, cut into cubes of edge / @p blocks voxels, of which each is an area.
 * @p edge is a multiple of @p blocks. */
conus_status volumes_blocks(conus_atlas **out, size_t edge, size_t blocks);

#endif
