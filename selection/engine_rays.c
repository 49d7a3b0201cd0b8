/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/evidence.h"

#include "base/math3.h"
#include "base/memory.h"
#include "selection/traverse.h"

#include <stdio.h>

struct target {
    const struct volume *volume;
    struct leap_map map;
};

struct rays_engine {
    struct engine base;
    size_t target_count;
    struct target targets[];
};

static void destroy(struct engine *engine)
{
    struct rays_engine *rays = (struct rays_engine *)engine;
    for (size_t i = 0; i < rays->target_count; i++) {
        leap_map_finish(&rays->targets[i].map);
    }
    memory_free(rays);
}

/* Nearest first; of equally near ones the object with the lower number. */
static void keep_nearer(struct evidence *out, size_t pixel, const struct volume *volume,
                        struct traverse_contact contact)
{
    if (contact.voxel == UINT64_MAX || contact.t > out->distance[pixel]) {
        return;
    }
    uint32_t object = volume_object(volume, (size_t)contact.voxel);
    if (contact.t < out->distance[pixel] || object < out->object[pixel]) {
        out->object[pixel] = object;
        out->distance[pixel] = contact.t;
        out->voxel[pixel] = contact.voxel;
    }
}

static void look_at(const struct target *target, struct evidence *out, const struct cone *cone)
{
    double origin[3];
    mat4_point(origin, target->volume->voxel_from_world, cone->pose.world_from_device + 12);
    uint32_t n = cone->resolution;
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            size_t pixel = (size_t)j * n + i;
            double direction[3];
            struct traverse_ray ray;
            cone_ray(direction, cone, i, j);
            mat4_direction(direction, target->volume->voxel_from_world, direction);
            traverse_ray_init(&ray, origin, direction);
            keep_nearer(out, pixel, target->volume, traverse_one(&target->map, &ray, out->distance[pixel]));
        }
    }
}

static conus_status look(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    const struct rays_engine *rays = (const struct rays_engine *)engine;
    evidence_clear(out);
    for (size_t i = 0; i < rays->target_count; i++) {
        look_at(&rays->targets[i], out, cone);
    }
    return CONUS_OK;
}

static conus_status add_targets(struct rays_engine *engine, const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role == CONUS_CONTEXT) {
            continue;
        }
        struct target *target = &engine->targets[engine->target_count];
        target->volume = volume;
        conus_status status = leap_map_init(&target->map, volume);
        if (status) {
            return status;
        }
        engine->target_count++;
    }
    return CONUS_OK;
}

conus_status engine_rays_create(struct engine **out, const conus_atlas *atlas, const struct engine_options *options)
{
    (void)options;
    static const struct engine_functions functions = {.look = look, .destroy = destroy};
    struct rays_engine *engine = memory_zeroed(1, sizeof *engine + atlas->volume_count * sizeof engine->targets[0]);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    engine->base.functions = &functions;
    snprintf(engine->base.name, sizeof engine->base.name, "rays, scalar");
    conus_status status = add_targets(engine, atlas);
    if (status) {
        destroy(&engine->base);
        return status;
    }
    *out = &engine->base;
    return CONUS_OK;
}
