/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays at the surfaces of an atlas, or of the brain phantom, 1 to 16 rays at once. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"

#include <stdio.h>

enum { WIDTHS = 5, SEED = 3 };

struct scene {
    conus_atlas *atlas;
    struct mesh_rays *rays;
    struct cone *cones;
    struct engine *engines[WIDTHS]; /* each with another number of rays at once */
    struct trace traces[WIDTHS];
};

static conus_status make_rays(struct scene *scene)
{
    size_t count = scene->atlas->object_count;
    struct mesh_object *objects = memory_zeroed(count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        objects[i].mesh = atlas_object_mesh(scene->atlas, (uint32_t)i + 1);
    }
    conus_status status = mesh_rays_create(&scene->rays, objects, count);
    memory_free(objects);
    return status;
}

/* The atlas that was asked for, or, where that has no surfaces, the brain phantom. */
static conus_status load_surfaces(conus_atlas **out, const struct bench *bench)
{
    char brain[128];
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, bench->options.atlas, NULL);
    if (!status && !atlas->mesh_count) {
        conus_atlas_destroy(atlas);
        atlas = NULL;
        status = bench_brain(brain, sizeof brain, bench);
        status = status ? status : conus_atlas_load(&atlas, brain, NULL);
    }
    *out = status ? NULL : atlas;
    return status;
}

static conus_status scene_init(struct scene *scene, const struct bench *bench)
{
    static const unsigned widths[WIDTHS] = {1, 4, 8, 16, 0};
    size_t count = bench->options.poses;
    conus_status status = load_surfaces(&scene->atlas, bench);
    status = status ? status : make_rays(scene);
    scene->cones = status ? NULL : memory_zeroed(count, sizeof *scene->cones);
    if (!scene->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    cones_round_meshes(scene->cones, count, scene->atlas, bench->options.angle, SEED);
    for (size_t w = 0; w < WIDTHS && !status; w++) {
        status = mesh_engine_create(&scene->engines[w], scene->rays, widths[w]);
        status = status ? status : trace_init(&scene->traces[w], scene->engines[w], scene->cones, count);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (size_t w = 0; w < WIDTHS; w++) {
        trace_finish(&scene->traces[w]);
        engine_destroy(scene->engines[w]);
    }
    memory_free(scene->cones);
    mesh_rays_destroy(scene->rays);
    conus_atlas_destroy(scene->atlas);
}

conus_status bench_mesh(struct bench *bench)
{
    struct scene scene = {0};
    struct bench_variant variants[WIDTHS];
    bench->one_thread = true;
    conus_status status = scene_init(&scene, bench);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", mesh_rays_name(scene.rays));
    }
    for (size_t w = 0; w < WIDTHS && !status; w++) {
        variants[w] = (struct bench_variant){.name = scene.traces[w].name, .run = trace_all, .data = &scene.traces[w]};
        variants[w].equal = trace_same(&scene.traces[w], &scene.traces[0]);
    }
    status =
        status ? status : bench_measure(bench, "mesh", variants, WIDTHS, bench->options.poses, bench->options.angle);
    scene_finish(&scene);
    return status;
}
