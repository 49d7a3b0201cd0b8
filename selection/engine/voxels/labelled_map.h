/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A distance map whose codes also say which object a voxel holds. So a ray that hits something need not read the
 * volume, which is far away in memory. The objects of AAL have codes 0 to 115, and a code of 116 + r is an empty voxel
 * with r empty ones around it. */
#ifndef CONUS_SELECTION_ENGINE_VOXELS_LABELLED_MAP_H
#define CONUS_SELECTION_ENGINE_VOXELS_LABELLED_MAP_H

#include "selection/engine/voxels/distance_map.h"

/** At most so many codes are objects; the others are distances, and larger distances are cut. */
enum { LABELLED_OBJECTS = 192 };

/** The largest grid, in codes, of which a labelled map is made: each process of a batch has one for itself. */
#define LABELLED_CODES ((size_t)1 << 26)

/** Makes the labelled map of a volume whose distance map @p map is. False without memory, and where the volume has no
 * objects, has more than LABELLED_CODES codes, or its objects' numbers are LABELLED_OBJECTS apart or more; then @p out
 * is as before. It takes a byte a voxel,
 * unless there is one object: then it has the codes of @p map, which must outlive it. */
bool labelled_map_init(struct distance_map *out, const struct volume *volume, const struct distance_map *map);

#endif
