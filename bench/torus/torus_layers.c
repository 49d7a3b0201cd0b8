/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10), against what is visible and against every triangle of every torus. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/engine.h"
#include "selection/evidence/layers.h"
#include "tests/support/oracle_triangle.h"

#include <stdio.h>
#include <string.h>

enum { TORUS_PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, LAYER_WAYS = 4 };

/* One way to answer all cones: an engine or a selector, all layers or what is visible. */
struct layer_way {
    struct engine *engine;    /* Borrowed; NULL = the selector answers. */
    conus_selector *selector; /* Owned; may be NULL.                    */
    bool layers;              /* All layers; false = what is visible.   */
    const struct cone *cones; /* [cone_count]                           */
    size_t cone_count;
    struct evidence *visible; /* [cone_count] of an engine              */
    struct layers *all_hits;  /* [cone_count]                           */
    conus_status status;      /* The last cone's without an answer.     */
};

struct layer_round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *rays;
    struct cone *cones; /* [cone_count] */
    size_t cone_count;
    struct layer_way ways[LAYER_WAYS];
};

enum { TORI = 20000 };

static conus_status layer_way_init(struct layer_round *round, size_t way, struct engine *engine, bool layers)
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

static void answer_all(void *data)
{
    struct layer_way *way = data;
    for (size_t i = 0; i < way->cone_count; i++) {
        conus_selection *selection = NULL;
        conus_status status = way->engine
                                  ? ask_engine(way, i)
                                  : conus_select(&selection, way->selector, &way->cones[i].pose, way->cones[i].angle);
        conus_selection_destroy(selection);
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

/* Pixels whose first interval is not what is visible, to the bit. */
static size_t count_other_firsts(const struct layer_way *layers, const struct layer_way *visible)
{
    size_t count = 0;
    for (size_t i = 0; i < layers->cone_count; i++) {
        const struct evidence *seen = &visible->visible[i];
        struct evidence *first = &layers->visible[i];
        (void)layers_first(first, &layers->all_hits[i]);
        for (size_t p = 0; p < TORUS_PIXELS; p++) {
            bool same = first->object[p] == seen->object[p] && first->voxel[p] == seen->voxel[p];
            count += !same || first->distance[p] != seen->distance[p];
        }
    }
    return count;
}

/* All triangles of a torus, if the ray passes the ball around it. */
static bool pierces(const struct mesh *mesh, const double centre[3], const double origin[3], const double direction[3])
{
    double away[3];
    vec3_sub(away, centre, origin);
    double along = vec3_dot(away, direction);
    bool found = false;
    int side;
    if (vec3_dot(away, away) - along * along <= 1.01 * TORUS_RADIUS * TORUS_RADIUS) {
        for (size_t i = 0; i < mesh->triangle_count && !found; i++) {
            found = oracle_triangle(&side, mesh, i, origin, direction) < INFINITY;
        }
    }
    return found;
}

/* Trying all triangles, over all cones. */
struct truth {
    size_t pierced, objects;            /* pairs of a ray and a torus in it; tori in the cone */
    size_t other_pierced, lost_objects; /* pairs that the intervals have otherwise; tori that they lack */
};

static void compare_torus(struct truth *truth, const struct cone *cone, const bool *has, const struct mesh *mesh,
                          const double centre[3])
{
    size_t wanted = 0, got = 0;
    for (uint32_t pixel = 0; pixel < TORUS_PIXELS; pixel++) {
        double direction[3];
        cone_ray(direction, cone, pixel % TORUS_RESOLUTION, pixel / TORUS_RESOLUTION);
        bool found = pierces(mesh, centre, cone->pose.world_from_device + 12, direction);
        wanted += found;
        got += has[pixel];
        truth->other_pierced += found != has[pixel];
    }
    truth->pierced += wanted;
    truth->objects += wanted > 0;
    truth->lost_objects += wanted > 0 && got == 0;
}

static conus_status find_truth(struct truth *out, const struct layer_way *way, const conus_atlas *atlas,
                               const struct torus_scene *scene)
{
    bool(*has)[TORUS_PIXELS] = memory_raw(scene->count, sizeof *has);
    if (!has) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < way->cone_count; i++) {
        memset(has, 0, scene->count * sizeof *has);
        for (size_t s = 0; s < way->all_hits[i].count; s++) {
            has[way->all_hits[i].intervals[s].object - 1][way->all_hits[i].intervals[s].pixel] = true;
        }
        for (size_t torus = 0; torus < scene->count; torus++) {
            compare_torus(out, &way->cones[i], has[torus], &atlas->meshes[torus], scene->places[torus] + 12);
        }
    }
    memory_free(has);
    return CONUS_OK;
}

static conus_status measure_layers(struct bench *bench, struct layer_round *round)
{
    static const char *const names[LAYER_WAYS] = {
        "20000 tori, rays engine, visible", "20000 tori, rays engine, all layers", "20000 tori, whole query, visible",
        "20000 tori, whole query, all layers"};
    struct bench_variant variants[LAYER_WAYS];
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < LAYER_WAYS && !status; w++) {
        status = layer_way_init(round, w, w < 2 ? round->rays : NULL, w % 2);
    }
    if (status) {
        return status;
    }
    for (int w = 0; w < LAYER_WAYS; w++) {
        answer_all(&round->ways[w]);
        variants[w] = (struct bench_variant){.name = names[w], .run = answer_all, .data = &round->ways[w]};
        variants[w].equal = !round->ways[w].status;
    }
    struct truth truth = {0};
    size_t firsts = count_other_firsts(&round->ways[1], &round->ways[0]);
    status = find_truth(&truth, &round->ways[1], round->atlas, &round->scene);
    double cones = (double)round->cone_count;
    printf("%zu tori: %.1f in a cone, pierced by %.1f rays each; against all triangles in double %zu of %zu pairs of a "
           "ray and a torus differ, %zu tori are missing; %zu first intervals are not what is visible\n",
           round->scene.count, (double)truth.objects / cones, (double)truth.pierced / (double)truth.objects,
           truth.other_pierced, truth.pierced, truth.lost_objects, firsts);
    bool equal = !firsts && !truth.lost_objects && truth.other_pierced <= truth.pierced / 10000;
    variants[1].equal = variants[1].equal && equal;
    variants[3].equal = variants[3].equal && equal;
    status = status ? status
                    : bench_measure(bench, "layers", variants, LAYER_WAYS, bench->options.poses, bench->options.angle);
    status = status ? status : bench_ratio(bench, "layers_over_visible", &variants[1], &variants[0]);
    return status ? status : bench_ratio(bench, "layers_over_visible_query", &variants[3], &variants[2]);
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
