/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/bench.h"
#include "apps/bench/mesh_look.h"
#include "apps/bench/torus_scene.h"
#include "base/math3.h"
#include "base/memory.h"
#include "selection/evidence.h"
#include "selection/mesh_rays.h"

#include <stdio.h>
#include <string.h>

enum { PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, WAYS = 8 };

/* Largest scene that is an atlas, too, whose tori have triangles of their own. */
enum { FLAT_LIMIT = 20000 };

/* One way to answer all cones. */
struct contender {
    const struct torus_scene *scene;
    const struct cone *cones;
    size_t cone_count;
    struct mesh_rays *rays; /* one torus at all places, with this many rays at once, 0 = as the engine chooses; */
    unsigned width;
    struct engine *engine;    /* or an engine on the scene's atlas */
    struct evidence *answers; /* [cone_count] */
    conus_status status;
    char name[96];
};

static conus_status contender_init(struct contender *out, const struct torus_scene *scene, const struct cone *cones,
                                   size_t cone_count)
{
    *out = (struct contender){.scene = scene, .cones = cones, .cone_count = cone_count};
    out->answers = memory_zeroed(cone_count, sizeof *out->answers);
    conus_status status = out->answers ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < cone_count && !status; i++) {
        status = evidence_init(&out->answers[i], TORUS_RESOLUTION);
    }
    return status;
}

static void contender_finish(struct contender *contender)
{
    for (size_t i = 0; contender->answers && i < contender->cone_count; i++) {
        evidence_finish(&contender->answers[i]);
    }
    memory_free(contender->answers);
}

static void answer_all(void *data)
{
    struct contender *contender = data;
    for (size_t i = 0; i < contender->cone_count; i++) {
        struct evidence *answer = &contender->answers[i];
        const struct cone *cone = &contender->cones[i];
        conus_status status = contender->engine ? contender->engine->functions->look(contender->engine, answer, cone)
                                                : bench_look_at_meshes(answer, contender->rays, cone, contender->width);
        contender->status = status ? status : contender->status;
    }
}

/* Pixels in which two contenders name different objects. */
static size_t count_differences(const struct contender *a, const struct contender *b)
{
    size_t count = 0;
    for (size_t i = 0; i < a->cone_count; i++) {
        for (size_t pixel = 0; pixel < PIXELS; pixel++) {
            count += a->answers[i].object[pixel] != b->answers[i].object[pixel];
        }
    }
    return count;
}

/* Everything about one number of tori. */
struct round {
    struct torus_scene scene;
    struct cone *cones;
    conus_atlas *atlas; /* NULL beyond FLAT_LIMIT */
    struct mesh_rays *rays;
    struct engine *engine;
    struct contender contenders[WAYS];
    size_t count;
};

static void round_finish(struct round *round)
{
    for (size_t i = 0; i < round->count; i++) {
        contender_finish(&round->contenders[i]);
    }
    engine_destroy(round->engine);
    mesh_rays_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

static conus_status place_all(struct round *round)
{
    size_t count = round->scene.count;
    struct mesh_object *objects = memory_zeroed(count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        objects[i] = (struct mesh_object){&round->scene.torus, round->scene.places[i]};
    }
    conus_status status = mesh_rays_create(&round->rays, objects, count);
    memory_free(objects);
    return status;
}

static conus_status add_contender(struct round *round, const struct bench_options *options, struct engine *engine,
                                  unsigned width, const char *what)
{
    struct contender *contender = &round->contenders[round->count++];
    conus_status status = contender_init(contender, &round->scene, round->cones, options->poses);
    contender->engine = engine;
    contender->rays = engine ? NULL : round->rays;
    contender->width = width;
    snprintf(contender->name, sizeof contender->name, "%zu tori, %s", round->scene.count, what);
    return status;
}

static conus_status add_placed(struct round *round, const struct bench_options *options)
{
    conus_status status = place_all(round);
    status = status ? status : add_contender(round, options, NULL, 1, "placed, 1 ray at once");
    status = status ? status : add_contender(round, options, NULL, 4, "placed, 4 rays at once");
    status = status ? status : add_contender(round, options, NULL, 8, "placed, 8 rays at once");
    status = status ? status : add_contender(round, options, NULL, 16, "placed, 16 rays at once");
    return status ? status : add_contender(round, options, NULL, 0, "placed, 1 or 16 by rule");
}

static conus_status add_flat(struct round *round, const struct bench_options *options)
{
    conus_status status = torus_scene_atlas(&round->atlas, &round->scene);
    status = status ? status : engine_rays_create(&round->engine, round->atlas, &(struct engine_options){0});
    return status ? status : add_contender(round, options, round->engine, 0, "rays engine");
}

static conus_status round_init(struct round *out, size_t tori, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&out->scene, tori);
    out->cones = status ? NULL : memory_zeroed(options->poses, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(out->cones, &out->scene, options->poses, options->angle);
    status = add_placed(out, options);
    return !status && tori <= bench_size(options, FLAT_LIMIT) ? add_flat(out, options) : status;
}

/* Answers once and compares. An atlas has moved vertices, which are rounded: its tori are not quite the placed ones,
 * and a ray in thousands tells. */
static void fill_in(struct bench_variant *out, struct round *round, struct contender *contender)
{
    answer_all(contender);
    size_t differ = count_differences(contender, &round->contenders[0]);
    size_t allowed = contender->engine ? contender->cone_count * PIXELS / 1000 : 0;
    *out = (struct bench_variant){.name = contender->name, .run = answer_all, .data = contender};
    out->equal = !contender->status && differ <= allowed;
    if (differ) {
        printf("%s: %zu of %zu pixels differ\n", contender->name, differ, contender->cone_count * PIXELS);
    }
}

static const size_t sizes[] = {1000, 5000, 20000, 200000};
enum { SIZES = sizeof sizes / sizeof sizes[0] };

/* All sizes side by side, since their ratio is wanted. */
static conus_status measure(struct bench *bench, struct round rounds[SIZES])
{
    struct bench_variant variants[SIZES * WAYS];
    const struct bench_variant *by_rule[SIZES];
    size_t count = 0;
    for (size_t s = 0; s < SIZES; s++) {
        for (size_t i = 0; i < rounds[s].count; i++) {
            struct contender *contender = &rounds[s].contenders[i];
            if (!contender->width && !contender->engine) {
                by_rule[s] = &variants[count];
            }
            fill_in(&variants[count++], &rounds[s], contender);
        }
    }
    conus_status status = bench_measure(bench, "torus", variants, count, bench->options.poses, bench->options.angle);
    return status ? status : bench_ratio(bench, "rays_200k_over_1k", by_rule[SIZES - 1], by_rule[0]);
}

conus_status bench_torus(struct bench *bench)
{
    struct round rounds[SIZES] = {0};
    bench->one_thread = true;
    conus_status status = CONUS_OK;
    for (size_t s = 0; s < SIZES && !status; s++) {
        status = round_init(&rounds[s], bench_size(&bench->options, sizes[s]), &bench->options);
    }
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", rounds[0].engine->name);
        status = measure(bench, rounds);
    }
    for (size_t s = 0; s < SIZES; s++) {
        round_finish(&rounds[s]);
    }
    return status ? status : bench_torus_gl(bench);
}
