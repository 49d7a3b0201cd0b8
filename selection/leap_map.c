/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/leap_map.h"

#include "base/memory.h"

#include <string.h>

void leap_map_finish(struct leap_map *map)
{
    memory_free(map->codes);
    *map = (struct leap_map){0};
}

static void mark_voxels(struct leap_map *map, const struct volume *volume)
{
    size_t voxel = 0;
    for (size_t k = 0; k < map->dim[2]; k++) {
        for (size_t j = 0; j < map->dim[1]; j++) {
            for (size_t i = 0; i < map->dim[0]; i++) {
                map->codes[leap_map_at(map, i, j, k)] = !volume_object(volume, voxel++);
            }
        }
    }
}

conus_status leap_map_init(struct leap_map *out, const struct volume *volume)
{
    struct leap_map map = {0};
    size_t count = 1;
    for (int a = 0; a < 3; a++) {
        map.dim[a] = volume->info.dim[a];
        map.bricks[a] = (map.dim[a] + LEAP_BRICK - 1) / LEAP_BRICK;
        count *= map.bricks[a]; /* below the number of voxels, which was checked */
    }
    map.codes = memory_raw(count, LEAP_BRICK_VOXELS);
    if (!map.codes) {
        return CONUS_ERROR_MEMORY;
    }
    memset(map.codes, 1, count * LEAP_BRICK_VOXELS);
    mark_voxels(&map, volume);
    *out = map;
    return CONUS_OK;
}
