/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a labelled map: moves the distances up, and writes the objects below them. */
#include "selection/engine/voxels/labelled_map.h"

#include "base/memory.h"

/* Of the volume's objects, the lowest and the highest number. */
static void find_objects(uint32_t *least, uint32_t *most, const struct volume *volume)
{
    uint32_t low = UINT32_MAX; /* of number - 1, by which voxels without an object do not count */
    uint32_t high = 0;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t object = volume_object(volume, v);
        low = object - 1 < low ? object - 1 : low;
        high = object > high ? object : high;
    }
    *least = low + 1;
    *most = high;
}

static void move_distances(struct distance_map *out, const struct distance_map *map)
{
    const uint8_t highest = (uint8_t)(UINT8_MAX - out->shift);
    const size_t count = distance_map_codes(map);
    for (size_t c = 0; c < count; c++) {
        uint8_t code = map->codes[c] < highest ? map->codes[c] : highest;
        out->codes[c] = (uint8_t)(code + out->shift);
    }
}

static void write_row(struct distance_map *out, const struct volume *volume, size_t j, size_t k)
{
    const size_t row = out->dim[0] * (j + out->dim[1] * k);
    for (size_t i = (size_t)out->first[0]; i <= (size_t)out->last[0]; i++) {
        uint32_t object = volume_object(volume, row + i);
        if (object) {
            out->codes[distance_map_at(out, i, j, k)] = (uint8_t)(object - out->least);
        }
    }
}

/* Outside the box there are none. */
static void write_objects(struct distance_map *out, const struct volume *volume)
{
    for (size_t k = (size_t)out->first[2]; k <= (size_t)out->last[2]; k++) {
        for (size_t j = (size_t)out->first[1]; j <= (size_t)out->last[1]; j++) {
            write_row(out, volume, j, k);
        }
    }
}

bool labelled_map_init(struct distance_map *out, const struct volume *volume, const struct distance_map *map)
{
    struct distance_map made = *map;
    uint32_t most;
    find_objects(&made.least, &most, volume);
    if (!most || most - made.least >= LABELLED_OBJECTS) {
        return false;
    }
    made.shift = most - made.least;
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
    move_distances(&made, map);
    write_objects(&made, volume);
    *out = made;
    return true;
}
