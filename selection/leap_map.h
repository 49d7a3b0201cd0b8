/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Which voxels of a volume hold an object, and how far around the others there is nothing: what lets a ray leap.
 *
 * One byte per voxel, its code: 0 where the voxel holds an object; else 1 + r, where all voxels of the grid that differ
 * from it by at most r in every index hold none. Bytes lie in bricks of 8 x 8 x 8, so that neighbours share cache
 * lines whatever the direction of a ray. */
#ifndef CONUS_SELECTION_LEAP_MAP_H
#define CONUS_SELECTION_LEAP_MAP_H

#include "atlas/volume.h"

enum { LEAP_BRICK = 8, LEAP_BRICK_VOXELS = 512 };

struct leap_map {
    size_t dim[3];    /**< Voxels along i, j, k.                        */
    size_t bricks[3]; /**< Bricks along i, j, k; the last may be padded. */
    double first[3];  /**< The box of the voxels with objects: lowest    */
    double last[3];   /**< and highest index; below the lowest if none.  */
    uint8_t *codes;   /**< [bricks[0] bricks[1] bricks[2] 512], and 512 unused bytes that may be read. */
    bool is_borrowed; /**< The codes are not the map's own. */
};

/** @p volume must have objects. Takes its leaps, if it has any, for as long as the volume has them. */
conus_status leap_map_init(struct leap_map *out, const struct volume *volume);
void leap_map_finish(struct leap_map *map);

/** Bytes of what leap_map_write() writes. */
size_t leap_map_size(const struct volume *volume);
/** Makes the leaps of a volume (volume->leaps) at @p memory, which is aligned as malloc's is. */
conus_status leap_map_write(void *memory, const struct volume *volume);

/** Position of voxel (i, j, k) among the codes. */
static inline size_t leap_map_at(const struct leap_map *map, size_t i, size_t j, size_t k)
{
    size_t brick = i / LEAP_BRICK + map->bricks[0] * (j / LEAP_BRICK + map->bricks[1] * (k / LEAP_BRICK));
    return brick * LEAP_BRICK_VOXELS + i % LEAP_BRICK + LEAP_BRICK * (j % LEAP_BRICK + LEAP_BRICK * (k % LEAP_BRICK));
}

#endif
