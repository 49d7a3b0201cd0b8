/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a labelled map: moves the distances up, and writes the objects below them. */
#include "selection/engine/voxels/distance_map.h"

#include "base/memory.h"

/* Called for each row along i of the box, outside which there are no objects; its first voxel has linear index
 * `voxel` in the volume. */
typedef void row_step(struct distance_map *map, const struct volume *volume, const size_t first[3], size_t voxel);

static void for_rows(struct distance_map *map, const struct volume *volume, row_step *step)
{
    const size_t i = (size_t)map->first[0];
    for (size_t k = (size_t)map->first[2]; k <= (size_t)map->last[2]; k++) {
        for (size_t j = (size_t)map->first[1]; j <= (size_t)map->last[1]; j++) {
            step(map, volume, (const size_t[3]){i, j, k}, i + map->dim[0] * (j + map->dim[1] * k));
        }
    }
}

static size_t row_length(const struct distance_map *map)
{
    return (size_t)(map->last[0] - map->first[0]) + 1;
}

/* Lowers `least`, and raises `shift`, which is the highest number for now. */
static void find_objects(struct distance_map *map, const struct volume *volume, const size_t first[3], size_t voxel)
{
    const size_t length = row_length(map);
    uint32_t least = map->least;
    uint32_t most = map->shift;
    (void)first;
    for (size_t i = 0; i < length; i++) {
        uint32_t object = volume_object(volume, voxel + i);
        if (object) {
            least = object < least ? object : least;
            most = object > most ? object : most;
        }
    }
    map->least = least;
    map->shift = most;
}

static void write_objects(struct distance_map *map, const struct volume *volume, const size_t first[3], size_t voxel)
{
    const size_t length = row_length(map);
    for (size_t i = 0; i < length; i++) {
        uint32_t object = volume_object(volume, voxel + i);
        if (object) {
            map->codes[distance_map_at(map, first[0] + i, first[1], first[2])] = (uint8_t)(object - map->least);
        }
    }
}

bool labelled_map_init(struct distance_map *out, const struct volume *volume, const struct distance_map *map)
{
    struct distance_map made = *map;
    made.least = UINT32_MAX;
    if (map->last[0] < map->first[0] || distance_map_codes(map) > LABELLED_CODES) {
        return false;
    }
    for_rows(&made, volume, find_objects);
    if (made.shift - made.least >= LABELLED_OBJECTS) {
        return false;
    }
    made.shift -= made.least;
    made.block = NULL;
    if (!made.shift) { /* of one object, whose codes need not change */
        *out = made;
        return true;
    }
    made.block = memory_raw(distance_map_codes(map) / DISTANCE_LINE + 1, DISTANCE_LINE);
    if (!made.block) {
        return false;
    }
    made.codes = distance_map_on_lines(made.block);
    const size_t count = distance_map_codes(map);
    const uint8_t shift = (uint8_t)made.shift;
    const uint8_t highest = (uint8_t)(UINT8_MAX - shift);
    const uint8_t *restrict from = map->codes;
    uint8_t *restrict to = made.codes;
    for (size_t c = 0; c < count; c++) {
        uint8_t code = from[c] < highest ? from[c] : highest;
        to[c] = (uint8_t)(code + shift);
    }
    for_rows(&made, volume, write_objects);
    *out = made;
    return true;
}
