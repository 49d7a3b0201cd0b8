/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates 20,000 tori with engines and cones, and answers the cones in several ways. */
#include "bench/torus/torus_ways.h"

#include "base/memory.h"

enum { TORI = 20000 };

conus_status layer_way_init(struct layer_round *round, size_t way, struct engine *engine, bool layers)
{
    struct layer_way *out = &round->ways[way];
    size_t count = round->cone_count;
    *out = (struct layer_way){.engine = engine, .layers = layers, .cones = round->cones, .cone_count = count};
    out->visible = memory_zeroed(count, sizeof *out->visible);
    out->all_hits = memory_zeroed(count, sizeof *out->all_hits);
    conus_status status = out->visible && out->all_hits ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        status = evidence_init(&out->visible[i], TORUS_RESOLUTION);
    }
    if (!status && !engine) {
        const conus_selector_options options = {.layers = layers ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE};
        status = conus_selector_create(&out->selector, round->atlas, &options);
    }
    return status;
}

static void way_finish(struct layer_way *way)
{
    for (size_t i = 0; i < way->cone_count && way->visible && way->all_hits; i++) {
        evidence_finish(&way->visible[i]);
        layers_finish(&way->all_hits[i]);
    }
    conus_selector_destroy(way->selector);
    memory_free(way->visible);
    memory_free(way->all_hits);
}

static conus_status ask_engine(struct layer_way *way, size_t cone)
{
    struct layers *all_hits = &way->all_hits[cone];
    if (!way->layers) {
        return way->engine->functions->trace(way->engine, &way->visible[cone], &way->cones[cone]);
    }
    layers_clear(all_hits);
    conus_status status = way->engine->functions->pierce(way->engine, all_hits, &way->cones[cone]);
    return status ? status : layers_sort(all_hits, TORUS_PIXELS);
}

static conus_status ask_selector(const struct layer_way *way, size_t cone)
{
    conus_selection *selection = NULL;
    conus_status status = conus_select(&selection, way->selector, &way->cones[cone].pose, way->cones[cone].angle);
    conus_selection_destroy(selection);
    return status;
}

static void answer_all(void *data)
{
    struct layer_way *way = data;
    for (size_t i = 0; i < way->cone_count; i++) {
        conus_status status = way->engine ? ask_engine(way, i) : ask_selector(way, i);
        way->status = status ? status : way->status;
    }
}

conus_status layer_round_init(struct layer_round *out, const struct bench_options *options, bool with_gl)
{
    static const struct engine_options defaults = {0};
    *out = (struct layer_round){.cone_count = options->poses};
    conus_status status = torus_scene_init(&out->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&out->atlas, &out->scene);
    status = status || !with_gl ? status : engine_gl_create(&out->gl, out->atlas, &defaults);
    status = status ? status : engine_rays_create(&out->rays, out->atlas, &defaults);
    out->cones = status ? NULL : memory_zeroed(options->poses, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(out->cones, &out->scene, options->poses, options->angle);
    return CONUS_OK;
}

void layer_round_finish(struct layer_round *round)
{
    for (int w = 0; w < LAYER_WAYS; w++) {
        way_finish(&round->ways[w]);
    }
    engine_destroy(round->gl);
    engine_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

void layer_round_variants(struct bench_variant variants[LAYER_WAYS], struct layer_round *round,
                          const char *const names[LAYER_WAYS])
{
    for (int w = 0; w < LAYER_WAYS; w++) {
        answer_all(&round->ways[w]);
        variants[w] = (struct bench_variant){.name = names[w], .run = answer_all, .data = &round->ways[w]};
        variants[w].equal = !round->ways[w].status;
    }
}
