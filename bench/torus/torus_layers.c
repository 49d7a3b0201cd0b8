/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10), against what is visible. */
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/engine.h"
#include "selection/evidence/layers.h"

#include <stdio.h>

enum { TORUS_PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, LAYER_WAYS = 2, TORI = 20000 };

/* One way to answer all cones: all layers or what is visible. */
struct layer_way {
    const struct layer_round *round;
    bool layers;              /* All layers; false = what is visible. */
    struct evidence *visible; /* [cone_count]                         */
    struct layers *all_hits;  /* [cone_count]                         */
    conus_status status;      /* The last cone's without an answer.   */
};

struct layer_round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *rays;
    struct cone *cones; /* [cone_count] */
    size_t cone_count;
    struct layer_way ways[LAYER_WAYS];
};

static conus_status layer_way_init(struct layer_round *round, size_t way)
{
    struct layer_way *out = &round->ways[way];
    size_t count = round->cone_count;
    *out = (struct layer_way){.round = round, .layers = way};
    out->visible = memory_zeroed(count, sizeof *out->visible);
    out->all_hits = memory_zeroed(count, sizeof *out->all_hits);
    conus_status status = out->visible && out->all_hits ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        status = evidence_init(&out->visible[i], TORUS_RESOLUTION);
    }
    return status;
}

static void way_finish(struct layer_way *way)
{
    for (size_t i = 0; way->visible && way->all_hits && i < way->round->cone_count; i++) {
        evidence_finish(&way->visible[i]);
        layers_finish(&way->all_hits[i]);
    }
    memory_free(way->visible);
    memory_free(way->all_hits);
}

static void answer_all(void *data)
{
    struct layer_way *way = data;
    struct engine *engine = way->round->rays;
    for (size_t i = 0; i < way->round->cone_count; i++) {
        const struct cone *cone = &way->round->cones[i];
        layers_clear(&way->all_hits[i]);
        conus_status status = way->layers ? engine->functions->pierce(engine, &way->all_hits[i], cone)
                                          : engine->functions->trace(engine, &way->visible[i], cone);
        status = status || !way->layers ? status : layers_sort(&way->all_hits[i], TORUS_PIXELS);
        way->status = status ? status : way->status;
    }
}

static conus_status layer_round_init(struct layer_round *out, const struct bench_options *options)
{
    static const struct engine_options defaults = {0};
    *out = (struct layer_round){.cone_count = options->poses};
    conus_status status = torus_scene_init(&out->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&out->atlas, &out->scene);
    status = status ? status : engine_rays_create(&out->rays, out->atlas, &defaults);
    out->cones = status ? NULL : memory_zeroed(options->poses, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(out->cones, &out->scene, options->poses, options->angle);
    return CONUS_OK;
}

static void layer_round_finish(struct layer_round *round)
{
    for (int w = 0; w < LAYER_WAYS; w++) {
        way_finish(&round->ways[w]);
    }
    engine_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

/* Whether the first interval of every pixel is what is visible, to the bit. */
static bool has_same_firsts(const struct layer_way *layers, const struct layer_way *visible)
{
    bool same = true;
    for (size_t i = 0; i < layers->round->cone_count; i++) {
        const struct evidence *seen = &visible->visible[i];
        struct evidence *first = &layers->visible[i];
        (void)layers_first(first, &layers->all_hits[i]);
        for (size_t p = 0; p < TORUS_PIXELS; p++) {
            same = same && first->object[p] == seen->object[p] && first->voxel[p] == seen->voxel[p] &&
                   first->distance[p] == seen->distance[p];
        }
    }
    return same;
}

static conus_status measure_layers(struct bench *bench, struct layer_round *round)
{
    struct bench_variant variants[LAYER_WAYS];
    for (size_t w = 0; w < LAYER_WAYS; w++) {
        conus_status status = layer_way_init(round, w);
        if (status) {
            return status;
        }
        answer_all(&round->ways[w]);
        variants[w] = (struct bench_variant){
            .name = w ? "20000 tori, all layers" : "20000 tori, visible", .run = answer_all, .data = &round->ways[w]};
        variants[w].equal = !round->ways[w].status;
    }
    variants[1].equal = variants[1].equal && has_same_firsts(&round->ways[1], &round->ways[0]);
    conus_status status =
        bench_measure(bench, "layers", variants, LAYER_WAYS, bench->options.poses, bench->options.angle);
    return status ? status : bench_ratio(bench, "layers_over_visible", &variants[1], &variants[0]);
}

conus_status bench_layers(struct bench *bench)
{
    struct layer_round round;
    bench->one_thread = true;
    conus_status status = layer_round_init(&round, &bench->options);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", round.rays->name);
        status = measure_layers(bench, &round);
    }
    layer_round_finish(&round);
    return status;
}
