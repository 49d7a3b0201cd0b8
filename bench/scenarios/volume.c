/* SPDX-License-Identifier: BSD-3-Clause */
/* 256 rays through a labelled volume: plain traversal against the rays engine. */
#include "bench/bench.h"

#include "base/memory.h"
#include "bench/support/trace.h"
#include "selection/engine/engine_rays.h"

#include <stdio.h>

enum { TRACES_LIMIT = 8, SEED = 2010 };

/* The plain traversal, then the rays engine with each kernel, then on slices. */
struct scene {
    conus_atlas *atlas;
    size_t cone_count;
    struct cone *cones;
    struct engine *engines[TRACES_LIMIT];
    struct trace traces[TRACES_LIMIT];
    size_t count;
};

static conus_status make_cones(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    if (!status && !atlas_parcellation(scene->atlas)) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", options->atlas);
    }
    scene->cones = status ? NULL : memory_zeroed(options->poses, sizeof *scene->cones);
    if (!scene->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    scene->cone_count = options->poses;
    cones_round_grid(scene->cones, scene->cone_count, &scene->atlas->volumes[0].info, options->angle, SEED);
    return CONUS_OK;
}

/* Takes the engine over. */
static conus_status add_trace(struct scene *scene, struct engine *engine)
{
    size_t i = scene->count++;
    scene->engines[i] = engine;
    return trace_init(&scene->traces[i], engine, scene->cones, scene->cone_count);
}

static conus_status add_rays(struct scene *scene, const struct traverse_kernel *kernel, conus_sampling sampling)
{
    struct engine *engine = NULL;
    const struct engine_options options = {.sampling = sampling};
    conus_status status = engine_rays_create_with(&engine, scene->atlas, &options, kernel);
    return status ? status : add_trace(scene, engine);
}

static conus_status add_traces(struct scene *scene)
{
    struct engine *plain = NULL;
    conus_status status = plain_engine_create(&plain, scene->atlas);
    status = status ? status : add_trace(scene, plain);
    for (size_t k = 0; traverse_kernel(k) && !status; k++) {
        if (traverse_kernel(k)->is_supported()) {
            status = add_rays(scene, traverse_kernel(k), CONUS_SAMPLING_EXACT);
        }
    }
    status = status ? status : add_rays(scene, traverse_best_kernel(), CONUS_SAMPLING_SLICES);
    struct trace *slices = &scene->traces[scene->count - 1];
    snprintf(slices->name, sizeof slices->name, "%s, slices", slices->engine ? slices->engine->name : "");
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (size_t i = 0; i < scene->count; i++) {
        trace_finish(&scene->traces[i]);
        engine_destroy(scene->engines[i]);
    }
    memory_free(scene->cones);
    conus_atlas_destroy(scene->atlas);
}

static void build_map(void *data)
{
    struct distance_map map;
    if (!distance_map_init(&map, data)) {
        distance_map_finish(&map);
    }
}

static conus_status measure_engines(struct bench *bench, struct scene *scene)
{
    struct bench_variant variants[TRACES_LIMIT];
    size_t count = scene->count;
    for (size_t i = 0; i < count; i++) {
        struct trace *trace = &scene->traces[i];
        variants[i] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
        variants[i].equal = trace_same(trace, &scene->traces[0]);
        variants[i].other_by_design = i == count - 1;
    }
    struct bench_variant build = {
        .name = "building the distance map", .run = build_map, .data = &scene->atlas->volumes[0], .equal = true};
    conus_status status = bench_measure(bench, "volume", variants, count, scene->cone_count, bench->options.angle);
    status = status ? status : bench_measure(bench, "volume", &build, 1, 1, 0);
    return status ? status : bench_ratio(bench, "dda_over_simd", &variants[0], &variants[1]);
}

conus_status bench_volume(struct bench *bench)
{
    struct scene scene = {0};
    conus_status status = make_cones(&scene, &bench->options);
    status = status ? status : add_traces(&scene);
    bench->one_thread = true;
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", scene.engines[1]->name);
        status = measure_engines(bench, &scene);
    }
    scene_finish(&scene);
    return status;
}
