/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/bench.h"

#include "base/math3.h"
#include "base/memory.h"
#include "selection/engine_rays.h"
#include "tests/oracle_traversal.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { RESOLUTION = 16, KERNEL_LIMIT = 8, SEED = 2010 };

/* A variant's engine and its answers; the plain traversal has no engine. */
struct contender {
    const struct scene *scene;
    struct engine *engine;
    struct evidence *answers; /* [poses] */
    struct evidence scratch;  /* what is timed goes here */
    char name[112];
    bool is_sliced;
    conus_status status;
};

struct scene {
    conus_atlas *atlas;
    size_t cone_count;
    struct cone *cones;
    struct contender contenders[KERNEL_LIMIT];
    size_t contender_count;
};

/* Round the head, 200 to 300 mm from its middle, aiming at points of its inner half. */
static void make_cone(struct cone *out, const conus_atlas *atlas, double angle, uint64_t *random)
{
    const conus_volume_info *info = &atlas->volumes[0].info;
    double centre[3], from[3], target[3];
    for (int a = 0; a < 3; a++) {
        centre[a] = 0.5 * (double)(info->dim[a] - 1);
        target[a] = centre[a] + bench_random(random, -0.25, 0.25) * (double)info->dim[a];
    }
    mat4_point(centre, info->world_from_voxel, centre);
    mat4_point(target, info->world_from_voxel, target);
    double z = bench_random(random, -1, 1);
    double turn = bench_random(random, 0, 2 * MATH3_PI);
    const double outward[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
    vec3_add_scaled(from, centre, bench_random(random, 200, 300), outward);
    *out = (struct cone){.angle = radians_from_degrees(angle), .resolution = RESOLUTION};
    conus_status status = conus_pose_toward(&out->pose, from, target, NULL);
    assert(!status);
    (void)status;
}

static conus_status make_scene(struct scene *scene, const struct bench_options *options)
{
    uint64_t random = SEED;
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    if (status) {
        return status;
    }
    scene->cones = memory_zeroed(options->poses, sizeof *scene->cones);
    if (!scene->cones) {
        return CONUS_ERROR_MEMORY;
    }
    scene->cone_count = options->poses;
    for (size_t i = 0; i < scene->cone_count; i++) {
        make_cone(&scene->cones[i], scene->atlas, options->angle, &random);
    }
    return CONUS_OK;
}

/* kernel NULL = the plain traversal */
static conus_status add_contender(struct scene *scene, const struct traverse_kernel *kernel,
                                  const struct engine_options *options, const char *what)
{
    struct contender *contender = &scene->contenders[scene->contender_count++];
    contender->scene = scene;
    contender->is_sliced = options->sampling == CONUS_SLICES;
    contender->answers = memory_zeroed(scene->cone_count, sizeof *contender->answers);
    conus_status status = contender->answers ? evidence_init(&contender->scratch, RESOLUTION) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < scene->cone_count && !status; i++) {
        status = evidence_init(&contender->answers[i], RESOLUTION);
    }
    if (kernel && !status) {
        status = engine_rays_create_with(&contender->engine, scene->atlas, options, kernel);
    }
    snprintf(contender->name, sizeof contender->name, "%s%s%s", contender->engine ? contender->engine->name : "",
             contender->engine && what[0] ? ", " : "", what);
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (size_t c = 0; c < scene->contender_count; c++) {
        struct contender *contender = &scene->contenders[c];
        for (size_t i = 0; i < scene->cone_count && contender->answers; i++) {
            evidence_finish(&contender->answers[i]);
        }
        evidence_finish(&contender->scratch);
        memory_free(contender->answers);
        engine_destroy(contender->engine);
    }
    memory_free(scene->cones);
    conus_atlas_destroy(scene->atlas);
}

static void look(struct contender *contender, struct evidence *out, const struct cone *cone)
{
    if (contender->engine) {
        conus_status status = contender->engine->functions->look(contender->engine, out, cone);
        contender->status = status ? status : contender->status;
    } else {
        oracle_look(out, contender->scene->atlas, cone);
    }
}

static void answer(struct contender *contender)
{
    for (size_t i = 0; i < contender->scene->cone_count; i++) {
        look(contender, &contender->answers[i], &contender->scene->cones[i]);
    }
}

static void look_from_everywhere(void *data)
{
    struct contender *contender = data;
    for (size_t i = 0; i < contender->scene->cone_count; i++) {
        look(contender, &contender->scratch, &contender->scene->cones[i]);
    }
}

static bool gives_the_same(const struct contender *contender, const struct contender *reference)
{
    size_t pixels = (size_t)RESOLUTION * RESOLUTION;
    for (size_t i = 0; i < contender->scene->cone_count; i++) {
        const struct evidence *a = &contender->answers[i];
        const struct evidence *b = &reference->answers[i];
        if (contender->status || memcmp(a->object, b->object, pixels * sizeof *a->object) != 0 ||
            memcmp(a->voxel, b->voxel, pixels * sizeof *a->voxel) != 0 ||
            memcmp(a->distance, b->distance, pixels * sizeof *a->distance) != 0) {
            return false;
        }
    }
    return true;
}

static void build_map(void *data)
{
    struct leap_map map;
    if (!leap_map_init(&map, data)) {
        leap_map_finish(&map);
    }
}

static conus_status add_contenders(struct scene *scene)
{
    const struct engine_options exact = {0};
    const struct engine_options slices = {.sampling = CONUS_SLICES};
    conus_status status = add_contender(scene, NULL, &exact, "plain scalar traversal");
    for (size_t k = 0; traverse_kernel(k) && !status; k++) {
        if (traverse_kernel(k)->is_supported()) {
            status = add_contender(scene, traverse_kernel(k), &exact, "");
        }
    }
    return status ? status : add_contender(scene, traverse_best_kernel(), &slices, "slices");
}

static conus_status measure(struct bench *bench, struct scene *scene)
{
    struct bench_variant variants[KERNEL_LIMIT];
    size_t count = scene->contender_count;
    for (size_t c = 0; c < count; c++) {
        struct contender *contender = &scene->contenders[c];
        variants[c] = (struct bench_variant){.name = contender->name, .run = look_from_everywhere, .data = contender};
        answer(contender);
        variants[c].equal = gives_the_same(contender, &scene->contenders[0]);
        variants[c].other_by_design = contender->is_sliced;
    }
    struct bench_variant build = {
        .name = "building the leap map", .run = build_map, .data = &scene->atlas->volumes[0], .equal = true};
    conus_status status = bench_measure(bench, "volume", variants, count, scene->cone_count, bench->options.angle);
    status = status ? status : bench_measure(bench, "volume", &build, 1, 1, 0);
    return status ? status : bench_ratio(bench, "dda_over_simd", &variants[0], &variants[1]);
}

conus_status bench_volume(struct bench *bench)
{
    struct scene scene = {0};
    conus_status status = make_scene(&scene, &bench->options);
    status = status ? status : add_contenders(&scene);
    bench->one_thread = true;
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", scene.contenders[1].engine->name);
        status = measure(bench, &scene);
    }
    scene_finish(&scene);
    return status;
}
