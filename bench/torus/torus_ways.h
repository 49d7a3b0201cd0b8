/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The scenarios on all layers of 20,000 tori: the scene, its engines, and the ways to answer its cones. */
#ifndef CONUS_BENCH_TORUS_TORUS_WAYS_H
#define CONUS_BENCH_TORUS_TORUS_WAYS_H

#include "bench/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/engine.h"
#include "selection/evidence/layers.h"

enum { TORUS_PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, LAYER_WAYS = 4 };

/** One way to answer all cones: an engine or a selector, all layers or what is visible. */
struct layer_way {
    struct engine *engine;    /**< Borrowed; NULL = the selector answers. */
    conus_selector *selector; /**< Owned; may be NULL.                    */
    bool layers;              /**< All layers; false = what is visible.   */
    const struct cone *cones; /**< [cone_count]                           */
    size_t cone_count;
    struct evidence *visible; /**< [cone_count] of an engine              */
    struct layers *all_hits;  /**< [cone_count]                           */
    conus_status status;      /**< Of the last cone without an answer.    */
};

struct layer_round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *gl; /**< NULL if it was not asked for. */
    struct engine *rays;
    struct cone *cones; /**< [cone_count] */
    size_t cone_count;
    struct layer_way ways[LAYER_WAYS];
};

/** Creates scene, engines and cones. End it with layer_round_finish() even if this fails. */
conus_status layer_round_init(struct layer_round *out, const struct bench_options *options, bool with_gl);
void layer_round_finish(struct layer_round *round);

/** Sets way number @p way up; @p engine NULL = a selector of the rays engine. */
conus_status layer_way_init(struct layer_round *round, size_t way, struct engine *engine, bool layers);

/** Answers all cones in all ways once, and makes the variants of @p names. */
void layer_round_variants(struct bench_variant variants[LAYER_WAYS], struct layer_round *round,
                          const char *const names[LAYER_WAYS]);

#endif
