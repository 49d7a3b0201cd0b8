/* SPDX-License-Identifier: BSD-3-Clause */
/* What empty-space skipping saves, by engine: a labelled volume with its distances and with ones that lead to the next
 * voxel. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"
#include "selection/engine/voxels/distance_map.h"

#include <stdio.h>
#include <string.h>

enum { SEED = 2010 };

/* With and without skipping, by rays and by OpenGL. */
enum { RAYS, RAYS_STEPS, GL, GL_STEPS, WAYS };

struct scene {
    conus_atlas *atlases[2];
    void *distances; /* of the second one */
    struct cone *cones;
    struct engine *engines[WAYS];
    struct trace traces[WAYS];
    size_t count; /* of ways: those of OpenGL may be missing */
};

/* No distance leads farther than the next voxel. */
static conus_status shorten_distances(struct scene *scene)
{
    struct volume *volume = &scene->atlases[1]->volumes[0];
    struct distance_map map;
    scene->distances = memory_raw(distance_map_size(volume), 1);
    conus_status status = scene->distances ? distance_map_write(scene->distances, volume) : CONUS_ERROR_MEMORY;
    volume->distances = status ? NULL : scene->distances;
    status = status ? status : distance_map_init(&map, volume);
    if (!status) {
        for (size_t i = 0; i < distance_map_codes(&map); i++) {
            map.codes[i] = map.codes[i] > 1 ? 1 : map.codes[i];
        }
        distance_map_finish(&map);
    }
    return status;
}

static conus_status add_way(struct scene *scene, int way, size_t cone_count)
{
    static const char *const names[WAYS] = {"labels, rays engine", "labels, rays engine, without skipping",
                                            "labels, gl engine", "labels, gl engine, without skipping"};
    const conus_atlas *atlas = scene->atlases[way % 2];
    const struct engine_options how = {0};
    conus_status status = way < GL ? engine_rays_create(&scene->engines[way], atlas, &how)
                                   : engine_gl_create(&scene->engines[way], atlas, &how);
    status = status ? status : trace_init(&scene->traces[way], scene->engines[way], scene->cones, cone_count);
    snprintf(scene->traces[way].name, sizeof scene->traces[way].name, "%s", names[way]);
    scene->count += !status;
    return status;
}

static conus_status scene_init(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlases[0], options->atlas, NULL);
    status = status ? status : conus_atlas_load(&scene->atlases[1], options->atlas, NULL);
    if (!status && !atlas_parcellation(scene->atlases[0])) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", options->atlas);
    }
    status = status ? status : shorten_distances(scene);
    scene->cones = status ? NULL : memory_zeroed(options->poses, sizeof *scene->cones);
    if (!scene->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    cones_round_grid(scene->cones, options->poses, &scene->atlases[0]->volumes[0].info, options->angle, SEED);
    for (int way = 0; way < WAYS && !status; way++) {
        status = add_way(scene, way, options->poses);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (int way = 0; way < WAYS; way++) {
        trace_finish(&scene->traces[way]);
        engine_destroy(scene->engines[way]);
    }
    memory_free(scene->cones);
    conus_atlas_destroy(scene->atlases[0]);
    conus_atlas_destroy(scene->atlases[1]);
    memory_free(scene->distances);
}

conus_status bench_skipping(struct bench *bench)
{
    struct scene scene = {0};
    struct bench_variant variants[WAYS];
    bench_draw_on_this_thread();
    conus_status status = scene_init(&scene, &bench->options);
    if (status == CONUS_ERROR_GL) {
        status = bench_leave_out(bench, "skipping by OpenGL");
    }
    for (size_t way = 0; way < scene.count; way++) {
        struct trace *trace = &scene.traces[way];
        variants[way] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
        variants[way].equal = trace_same(trace, &scene.traces[RAYS]);
    }
    if (!status) {
        const char *gl = scene.count > GL ? scene.engines[GL]->name : "";
        bench->one_thread = scene.count <= GL || strstr(gl, "llvmpipe");
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", scene.engines[RAYS]->name, gl);
        status = bench_measure(bench, "skipping", variants, scene.count, bench->options.poses, bench->options.angle);
    }
    status = status ? status : bench_ratio(bench, "rays_steps_over_leaps", &variants[RAYS_STEPS], &variants[RAYS]);
    if (!status && scene.count > GL) {
        status = bench_ratio(bench, "gl_steps_over_leaps", &variants[GL_STEPS], &variants[GL]);
    }
    scene_finish(&scene);
    return status;
}
