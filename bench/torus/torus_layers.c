/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10), against what is visible. */
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/engine.h"
#include "selection/evidence/layers.h"

#include <stdio.h>

enum { VISIBLE, ALL, WAYS, TORUS_PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, TORI = 20000 };

struct layer_round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *rays;
    struct cone *cones; /* [cone_count] */
    size_t cone_count;
    struct evidence visible, first; /* of the last cone: by tracing, and by its layers */
    struct layers all_hits;
    conus_status status; /* The last cone's without an answer. */
};

static void see(struct layer_round *round, const struct cone *cone)
{
    conus_status status = round->rays->functions->trace(round->rays, &round->visible, cone);
    round->status = status ? status : round->status;
}

static void pierce(struct layer_round *round, const struct cone *cone)
{
    layers_clear(&round->all_hits);
    conus_status status = round->rays->functions->pierce(round->rays, &round->all_hits, cone);
    status = status ? status : layers_sort(&round->all_hits, TORUS_PIXELS);
    round->status = status ? status : round->status;
}

static void see_all(void *data)
{
    struct layer_round *round = data;
    for (size_t i = 0; i < round->cone_count; i++) {
        see(round, &round->cones[i]);
    }
}

static void pierce_all(void *data)
{
    struct layer_round *round = data;
    for (size_t i = 0; i < round->cone_count; i++) {
        pierce(round, &round->cones[i]);
    }
}

static conus_status layer_round_init(struct layer_round *out, const struct bench_options *options)
{
    *out = (struct layer_round){.cone_count = options->poses};
    conus_status status = torus_scene_init(&out->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&out->atlas, &out->scene);
    status = status ? status : engine_rays_create(&out->rays, out->atlas, &(struct engine_options){0});
    status = status ? status : evidence_init(&out->visible, TORUS_RESOLUTION);
    status = status ? status : evidence_init(&out->first, TORUS_RESOLUTION);
    out->cones = status ? NULL : memory_zeroed(options->poses, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(out->cones, &out->scene, options->poses, options->angle);
    return CONUS_OK;
}

static void layer_round_finish(struct layer_round *round)
{
    evidence_finish(&round->visible);
    evidence_finish(&round->first);
    layers_finish(&round->all_hits);
    engine_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

/* Whether the first interval of every pixel is what is visible, to the bit. */
static bool has_same_firsts(struct layer_round *round)
{
    const struct evidence *first = &round->first, *seen = &round->visible;
    bool same = true;
    for (size_t i = 0; i < round->cone_count; i++) {
        see(round, &round->cones[i]);
        pierce(round, &round->cones[i]);
        (void)layers_first(&round->first, &round->all_hits);
        for (size_t p = 0; p < TORUS_PIXELS; p++) {
            same = same && first->object[p] == seen->object[p] && first->voxel[p] == seen->voxel[p] &&
                   first->distance[p] == seen->distance[p];
        }
    }
    return same && !round->status;
}

conus_status bench_layers(struct bench *bench)
{
    struct layer_round round;
    bench->one_thread = true;
    conus_status status = layer_round_init(&round, &bench->options);
    if (!status) {
        bool same = has_same_firsts(&round);
        struct bench_variant variants[WAYS] = {
            {.name = "20000 tori, visible", .run = see_all, .data = &round, .equal = same},
            {.name = "20000 tori, all layers", .run = pierce_all, .data = &round, .equal = same}};
        snprintf(bench->driver, sizeof bench->driver, "%s", round.rays->name);
        status = bench_measure(bench, "layers", variants, WAYS, bench->options.poses, bench->options.angle);
        status = status ? status : bench_ratio(bench, "layers_over_visible", &variants[ALL], &variants[VISIBLE]);
    }
    layer_round_finish(&round);
    return status;
}
