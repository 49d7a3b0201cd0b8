/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/bench.h"
#include "apps/bench/mesh_look.h"
#include "base/math3.h"
#include "base/memory.h"

#include <assert.h>
#include <stdio.h>

enum { WIDTHS = 5, SEED = 3, PIXELS = MESH_LOOK_RESOLUTION * MESH_LOOK_RESOLUTION };

struct scene {
    conus_atlas *atlas;
    struct mesh_rays *rays;
    struct cone *cones;
    size_t cone_count;
};

/* One number of rays at once. */
struct way {
    const struct scene *scene;
    unsigned width; /* 0 = as the engine chooses */
    struct evidence *answers;
    conus_status status;
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

static void find_bounds(const conus_atlas *atlas, double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (size_t m = 0; m < atlas->mesh_count; m++) {
        for (size_t i = 0; i < 3 * atlas->meshes[m].vertex_count; i++) {
            double x = (double)atlas->meshes[m].positions[i];
            low[i % 3] = fmin(low[i % 3], x);
            high[i % 3] = fmax(high[i % 3], x);
        }
    }
}

/* From one to one and a half times the scene's size from its middle, aiming at points of its inner half. */
static void make_cones(struct scene *scene, double angle)
{
    uint64_t random = SEED;
    double low[3], high[3], size[3];
    find_bounds(scene->atlas, low, high);
    vec3_sub(size, high, low);
    for (size_t i = 0; i < scene->cone_count; i++) {
        double from[3], target[3];
        double z = bench_random(&random, -1, 1);
        double turn = bench_random(&random, 0, 2 * MATH3_PI);
        double away = fmax(size[0], fmax(size[1], size[2])) * bench_random(&random, 1, 1.5);
        const double outward[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        for (int a = 0; a < 3; a++) {
            double middle = 0.5 * (low[a] + high[a]);
            from[a] = middle + away * outward[a];
            target[a] = middle + bench_random(&random, -0.25, 0.25) * size[a];
        }
        struct cone *cone = &scene->cones[i];
        *cone = (struct cone){.angle = radians_from_degrees(angle), .resolution = MESH_LOOK_RESOLUTION};
        conus_status status = conus_pose_toward(&cone->pose, from, target, NULL);
        assert(!status);
        (void)status;
    }
}

/* The atlas that was asked for, or, where that has no surfaces, the brain phantom. */
static conus_status load(conus_atlas **out, const struct bench *bench)
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
    conus_status status = load(&scene->atlas, bench);
    status = status ? status : make_rays(scene);
    scene->cone_count = bench->options.poses;
    scene->cones = status ? NULL : memory_zeroed(scene->cone_count, sizeof *scene->cones);
    if (!scene->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    make_cones(scene, bench->options.angle);
    return CONUS_OK;
}

static void scene_finish(struct scene *scene)
{
    memory_free(scene->cones);
    mesh_rays_destroy(scene->rays);
    conus_atlas_destroy(scene->atlas);
}

static conus_status way_init(struct way *out, const struct scene *scene, unsigned width)
{
    *out = (struct way){.scene = scene, .width = width};
    out->answers = memory_zeroed(scene->cone_count, sizeof *out->answers);
    conus_status status = out->answers ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < scene->cone_count && !status; i++) {
        status = evidence_init(&out->answers[i], MESH_LOOK_RESOLUTION);
    }
    return status;
}

static void way_finish(struct way *way)
{
    for (size_t i = 0; way->answers && i < way->scene->cone_count; i++) {
        evidence_finish(&way->answers[i]);
    }
    memory_free(way->answers);
}

static void look_all(void *data)
{
    struct way *way = data;
    for (size_t i = 0; i < way->scene->cone_count; i++) {
        conus_status status =
            bench_look_at_meshes(&way->answers[i], way->scene->rays, &way->scene->cones[i], way->width);
        way->status = status ? status : way->status;
    }
}

static bool gives_the_same(const struct way *a, const struct way *b)
{
    bool same = !a->status && !b->status;
    for (size_t i = 0; i < a->scene->cone_count * PIXELS && same; i++) {
        const struct evidence *x = &a->answers[i / PIXELS];
        const struct evidence *y = &b->answers[i / PIXELS];
        same = x->object[i % PIXELS] == y->object[i % PIXELS] && x->distance[i % PIXELS] == y->distance[i % PIXELS];
    }
    return same;
}

conus_status bench_mesh(struct bench *bench)
{
    static const struct {
        unsigned width;
        const char *name;
    } kinds[WIDTHS] = {{1, "1 ray at once"},
                       {4, "4 rays at once"},
                       {8, "8 rays at once"},
                       {16, "16 rays at once"},
                       {0, "1 or 16 by rule"}};
    struct scene scene = {0};
    struct way ways[WIDTHS] = {0};
    struct bench_variant variants[WIDTHS];
    bench->one_thread = true;
    snprintf(bench->driver, sizeof bench->driver, "Embree 3");
    conus_status status = scene_init(&scene, bench);
    for (size_t w = 0; w < WIDTHS && !status; w++) {
        status = way_init(&ways[w], &scene, kinds[w].width);
        if (!status) {
            look_all(&ways[w]);
            variants[w] = (struct bench_variant){.name = kinds[w].name, .run = look_all, .data = &ways[w]};
            variants[w].equal = gives_the_same(&ways[w], &ways[0]);
        }
    }
    status =
        status ? status : bench_measure(bench, "mesh", variants, WIDTHS, bench->options.poses, bench->options.angle);
    for (size_t w = 0; w < WIDTHS; w++) {
        way_finish(&ways[w]);
    }
    scene_finish(&scene);
    return status;
}
