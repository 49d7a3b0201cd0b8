/* SPDX-License-Identifier: BSD-3-Clause */
/* What each step of the gl engine's mesh pass is worth: 20,000 tori with all of them, and without one at a time. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_scene.h"
#include "render/gl/context.h"
#include "render/id/mesh_pass.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TORI = 20000, CONES = 4, PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION };

static const struct {
    unsigned without;
    const char *name;
} kinds[] = {{0, "all steps"},
             {MESH_OCCLUSION, "without leaving out what is hidden"},
             {MESH_ORDER, "without nearest first"},
             {MESH_ORDER | MESH_OCCLUSION, "without nearest first, nor leaving out what is hidden"},
             {MESH_CULL, "without leaving out what is outside"},
             {MESH_CULL | MESH_ORDER | MESH_OCCLUSION, "without any"}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* The mesh pass of an atlas, alone. */
struct pass {
    struct gl_context *context;
    struct mesh_pass *meshes;
    double origins[PIXELS][3], directions[PIXELS][3];
};

/* It with some steps left out, as an engine. */
struct step_engine {
    struct engine base;
    struct pass *pass;
    unsigned without;
};

static conus_status trace_with_steps(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    const struct step_engine *own = (struct step_engine *)engine;
    struct pass *pass = own->pass;
    uint32_t n = cone->resolution;
    struct gl_current previous;
    const struct mesh_query query = {
        {cone->pose.world_from_device, tan(cone->angle / 2), cone->radius, n, own->without},
        {(const double(*)[3])pass->origins, (const double(*)[3])pass->directions, out->object, out->distance,
         out->voxel}};
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        cone_origin(pass->origins[pixel], cone, pixel % n, pixel / n);
        cone_ray(pass->directions[pixel], cone, pixel % n, pixel / n);
    }
    conus_status status = gl_context_use(pass->context, &previous);
    if (status) {
        return status;
    }
    evidence_clear(out);
    status = mesh_pass_render(pass->meshes, &query, 1);
    gl_current_restore(&previous);
    return status;
}

struct scene {
    struct torus_scene tori;
    conus_atlas *atlas;
    struct engine *rays; /* with whose answers the others are compared */
    struct pass pass;
    struct step_engine engines[KINDS];
    struct cone cones[CONES];
    struct trace traces[KINDS], truth;
};

static conus_status create_pass(struct pass *pass, const conus_atlas *atlas)
{
    struct gl_current previous;
    uint64_t memory_left = UINT64_MAX;
    const struct mesh **meshes = memory_raw(atlas->object_count, sizeof(void *));
    if (!meshes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->object_count; i++) {
        meshes[i] = atlas_object_mesh(atlas, (uint32_t)i + 1);
    }
    conus_status status = gl_context_create(&pass->context, NULL, NULL);
    status = status ? status : gl_context_use(pass->context, &previous);
    if (!status) {
        status = mesh_pass_create(&pass->meshes, meshes, atlas->object_count, &memory_left);
        gl_current_restore(&previous);
    }
    memory_free(meshes);
    return status;
}

static void destroy_pass(struct pass *pass)
{
    struct gl_current previous;
    if (pass->context && !gl_context_use(pass->context, &previous)) {
        mesh_pass_destroy(pass->meshes);
        gl_current_restore(&previous);
    }
    gl_context_destroy(pass->context);
}

static conus_status scene_init(struct scene *scene, const struct bench_options *options)
{
    static const struct engine_functions functions = {.trace = trace_with_steps};
    conus_status status = torus_scene_init(&scene->tori, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&scene->atlas, &scene->tori);
    status = status ? status : create_pass(&scene->pass, scene->atlas);
    status = status ? status : engine_rays_create(&scene->rays, scene->atlas, &(struct engine_options){0});
    if (status) {
        return status;
    }
    torus_scene_cones(scene->cones, &scene->tori, CONES, options->angle);
    status = trace_init(&scene->truth, scene->rays, scene->cones, CONES);
    for (int k = 0; k < KINDS && !status; k++) {
        struct step_engine *engine = &scene->engines[k];
        *engine = (struct step_engine){{&functions, ""}, &scene->pass, kinds[k].without};
        status = trace_init(&scene->traces[k], &engine->base, scene->cones, CONES);
        snprintf(scene->traces[k].name, sizeof scene->traces[k].name, "%zu tori, %s", scene->tori.count, kinds[k].name);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (int k = 0; k < KINDS; k++) {
        trace_finish(&scene->traces[k]);
    }
    trace_finish(&scene->truth);
    engine_destroy(scene->rays);
    destroy_pass(&scene->pass);
    conus_atlas_destroy(scene->atlas);
    torus_scene_finish(&scene->tori);
}

conus_status bench_steps(struct bench *bench)
{
    struct scene *scene = memory_zeroed(1, sizeof *scene);
    struct bench_variant variants[KINDS];
    bench_draw_on_this_thread();
    conus_status status = scene ? scene_init(scene, &bench->options) : CONUS_ERROR_MEMORY;
    if (!status) {
        const char *device = gl_context_renderer(scene->pass.context);
        bench->one_thread = strstr(device, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "gl, %s", device);
        for (int k = 0; k < KINDS; k++) {
            struct trace *own = &scene->traces[k];
            variants[k] = (struct bench_variant){.name = own->name, .run = trace_all, .data = own};
            variants[k].equal = trace_same_but_edges(own, &scene->truth);
        }
        status = bench_measure(bench, "steps", variants, KINDS, CONES, bench->options.angle);
    }
    status = status ? status : bench_ratio(bench, "gl_without_any_step_over_all", &variants[KINDS - 1], &variants[0]);
    if (scene) {
        scene_finish(scene);
    }
    memory_free(scene);
    return status;
}
