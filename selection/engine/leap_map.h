/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Which voxels of a volume hold an object, and how far around the others there is nothing: what lets a ray leap.
 *
 * One byte per voxel, its code: 0 where the voxel holds an object; else 1 + r, where all voxels of the grid that differ
 * from it by at most r in every index hold none. There is a margin of empty voxels around the grid, with codes of their
 * own. Bytes lie in lines of 4 x 4 x 4, the size of the processor's, so that neighbours share them whatever the
 * direction of a ray. */
#ifndef CONUS_SELECTION_ENGINE_LEAP_MAP_H
#define CONUS_SELECTION_ENGINE_LEAP_MAP_H

#include "atlas/volume.h"

enum { LEAP_MARGIN = 1, LEAP_EDGE = 4, LEAP_LINE = 64 };

struct leap_map {
    size_t dim[3];   /**< Voxels along i, j, k.                         */
    size_t lines[3]; /**< Lines along i, j, k; the last may be padded.   */
    double first[3]; /**< The box of the voxels with objects: lowest     */
    double last[3];  /**< and highest index; below the lowest if none.   */
    uint8_t *codes;  /**< [leap_map_codes()], in                          */
    void *block;     /**< this memory; NULL if they are not the map's own. */
};

/** @p volume must have objects. Takes its leaps, if it has any, for as long as the volume has them. */
conus_status leap_map_init(struct leap_map *out, const struct volume *volume);
void leap_map_finish(struct leap_map *map);

/** Bytes of what leap_map_write() writes. */
size_t leap_map_size(const struct volume *volume);
/** Makes the leaps of a volume (volume->leaps) at @p memory, which is aligned as malloc's is, better as a line. */
conus_status leap_map_write(void *memory, const struct volume *volume);

/** How many codes there are. */
static inline size_t leap_map_codes(const struct leap_map *map)
{
    return map->lines[0] * map->lines[1] * map->lines[2] * LEAP_LINE;
}

/** Position of voxel (i, j, k) among the codes; those of the margin in front are (size_t)-LEAP_MARGIN. */
static inline size_t leap_map_at(const struct leap_map *map, size_t i, size_t j, size_t k)
{
    size_t x = i + LEAP_MARGIN;
    size_t y = j + LEAP_MARGIN;
    size_t z = k + LEAP_MARGIN;
    size_t line = x / LEAP_EDGE + map->lines[0] * (y / LEAP_EDGE + map->lines[1] * (z / LEAP_EDGE));
    return line * LEAP_LINE + x % LEAP_EDGE + LEAP_EDGE * (y % LEAP_EDGE + LEAP_EDGE * (z % LEAP_EDGE));
}

#endif
