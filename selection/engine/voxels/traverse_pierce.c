/* SPDX-License-Identifier: BSD-3-Clause */
/* The walk of one ray that lists the intervals in all objects of a volume. */
#include "selection/engine/voxels/traverse.h"

/* Ends the interval at t, where the ray comes into a cell of `object`, and begins that one's. */
static conus_status change_object(struct layers *out, conus_interval *interval, uint32_t object, double t,
                                  uint64_t voxel)
{
    conus_status status = CONUS_OK;
    if (interval->object) {
        interval->exit = t;
        status = layers_add(out, interval);
    }
    interval->object = object;
    interval->entry = t;
    interval->voxel = voxel;
    return status;
}

conus_status traverse_pierce(struct layers *out, const struct distance_map *map, const struct volume *volume,
                             const struct traverse_ray *ray, uint32_t pixel)
{
    conus_status status = CONUS_OK;
    conus_interval interval = {.pixel = pixel};
    struct traverse_place at;
    bool inside = traverse_enter(map, ray, &at);
    while (inside && !status) {
        int code = traverse_code(map, &at);
        size_t voxel = traverse_voxel(map, &at);
        uint32_t object = code ? 0 : volume_object(volume, voxel);
        if (object != interval.object) {
            status = change_object(out, &interval, object, at.t, voxel);
        }
        inside = traverse_skip(map, ray, code ? code - 1 : 0, &at);
    }
    return status ? status : change_object(out, &interval, 0, at.t, 0);
}
