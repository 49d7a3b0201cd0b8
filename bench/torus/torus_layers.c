/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10), against what is visible and against every triangle of every torus. */
#include "base/math3.h"
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/layers.h"

#include <stdio.h>
#include <string.h>

enum { PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, TORI = 20000, WAYS = 4 };

/* One way to answer all cones: an engine alone or with what follows, all layers or what is visible. */
struct way {
    struct engine *engine; /* or a selector */
    conus_selector *selector;
    bool layers;
    const struct cone *cones;
    size_t cone_count;
    struct evidence *visible; /* [cone_count] of an engine */
    struct layers *pieces;    /* [cone_count]              */
    conus_status status;
};

static conus_status way_init(struct way *way, struct engine *engine, bool layers, const struct cone *cones,
                             size_t cone_count)
{
    *way = (struct way){.engine = engine, .layers = layers, .cones = cones, .cone_count = cone_count};
    way->visible = memory_zeroed(cone_count, sizeof *way->visible);
    way->pieces = memory_zeroed(cone_count, sizeof *way->pieces);
    conus_status status = way->visible && way->pieces ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < cone_count && !status; i++) {
        status = evidence_init(&way->visible[i], TORUS_RESOLUTION);
    }
    return status;
}

static void way_finish(struct way *way)
{
    for (size_t i = 0; i < way->cone_count && way->visible && way->pieces; i++) {
        evidence_finish(&way->visible[i]);
        layers_finish(&way->pieces[i]);
    }
    conus_selector_destroy(way->selector);
    memory_free(way->visible);
    memory_free(way->pieces);
}

static conus_status ask_engine(struct way *way, size_t cone)
{
    struct layers *pieces = &way->pieces[cone];
    if (!way->layers) {
        return way->engine->functions->look(way->engine, &way->visible[cone], &way->cones[cone]);
    }
    layers_clear(pieces);
    conus_status status = way->engine->functions->pierce(way->engine, pieces, &way->cones[cone]);
    return status ? status : layers_sort(pieces, PIXELS);
}

static conus_status ask_selector(const struct way *way, size_t cone)
{
    conus_selection *selection = NULL;
    conus_status status = conus_select(&selection, way->selector, &way->cones[cone].pose, way->cones[cone].angle);
    conus_selection_destroy(selection);
    return status;
}

static void answer_all(void *data)
{
    struct way *way = data;
    for (size_t i = 0; i < way->cone_count; i++) {
        conus_status status = way->engine ? ask_engine(way, i) : ask_selector(way, i);
        way->status = status ? status : way->status;
    }
}

/* ---- Is it right? ------------------------------------------------------------------------------------------- */

/* Pixels whose first piece is not what is visible, to the bit. */
static size_t count_other_firsts(const struct way *layers, const struct way *visible)
{
    size_t count = 0;
    for (size_t i = 0; i < layers->cone_count; i++) {
        const struct evidence *seen = &visible->visible[i];
        struct evidence *first = &layers->visible[i];
        layers_first(first, &layers->pieces[i]);
        for (size_t p = 0; p < PIXELS; p++) {
            bool same = first->object[p] == seen->object[p] && first->voxel[p] == seen->voxel[p];
            count += !same || first->distance[p] != seen->distance[p];
        }
    }
    return count;
}

static void corner(double out[3], const struct mesh *mesh, size_t triangle, size_t k)
{
    const float *p = &mesh->positions[3 * (size_t)mesh->triangles[3 * triangle + k]];
    for (int a = 0; a < 3; a++) {
        out[a] = (double)p[a];
    }
}

/* Moeller and Trumbore. */
static bool hits_triangle(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3])
{
    double p[3][3], across[3], from[3], turned[3];
    for (size_t k = 0; k < 3; k++) {
        corner(p[k], mesh, triangle, k);
    }
    vec3_sub(p[1], p[1], p[0]);
    vec3_sub(p[2], p[2], p[0]);
    vec3_cross(across, direction, p[2]);
    vec3_sub(from, origin, p[0]);
    vec3_cross(turned, from, p[1]);
    double scale = 1 / vec3_dot(p[1], across);
    double u = vec3_dot(from, across) * scale, v = vec3_dot(direction, turned) * scale;
    return u >= 0 && v >= 0 && u + v <= 1 && vec3_dot(p[2], turned) * scale >= 0;
}

/* All triangles of a torus, if the ray passes the ball around it. */
static bool pierces(const struct mesh *mesh, const double centre[3], const double origin[3], const double direction[3])
{
    double away[3];
    vec3_sub(away, centre, origin);
    double along = vec3_dot(away, direction);
    bool found = false;
    if (vec3_dot(away, away) - along * along <= 1.01 * TORUS_RADIUS * TORUS_RADIUS) {
        for (size_t i = 0; i < mesh->triangle_count && !found; i++) {
            found = hits_triangle(mesh, i, origin, direction);
        }
    }
    return found;
}

/* What all triangles say of one cone. */
struct truth {
    size_t pierced, objects;            /* pairs of a ray and a torus in it; tori in the cone */
    size_t other_pierced, lost_objects; /* pairs that the pieces have otherwise; tori that they lack */
};

static void compare_torus(struct truth *truth, const struct cone *cone, const bool *has, const struct mesh *mesh,
                          const double centre[3])
{
    size_t wanted = 0, got = 0;
    for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
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

static conus_status find_truth(struct truth *out, const struct way *way, const conus_atlas *atlas,
                               const struct torus_scene *scene)
{
    bool(*has)[PIXELS] = memory_raw(scene->count, sizeof *has);
    if (!has) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < way->cone_count; i++) {
        memset(has, 0, scene->count * sizeof *has);
        for (size_t s = 0; s < way->pieces[i].count; s++) {
            has[way->pieces[i].spans[s].object - 1][way->pieces[i].spans[s].pixel] = true;
        }
        for (size_t torus = 0; torus < scene->count; torus++) {
            compare_torus(out, &way->cones[i], has[torus], &atlas->meshes[torus], scene->places[torus] + 12);
        }
    }
    memory_free(has);
    return CONUS_OK;
}

/* ---- The scenario --------------------------------------------------------------------------------------------- */

struct round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *engine;
    struct cone *cones;
    struct way ways[WAYS];
};

static conus_status round_init(struct round *round, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&round->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&round->atlas, &round->scene);
    status = status ? status : engine_rays_create(&round->engine, round->atlas, &(struct engine_options){0});
    round->cones = status ? NULL : memory_zeroed(options->poses, sizeof *round->cones);
    if (!round->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(round->cones, &round->scene, options->poses, options->angle);
    for (int w = 0; w < WAYS && !status; w++) {
        bool layers = w % 2;
        status = way_init(&round->ways[w], w < 2 ? round->engine : NULL, layers, round->cones, options->poses);
        if (!status && w >= 2) {
            const conus_selector_options how = {.layers = layers ? CONUS_ALL_LAYERS : CONUS_VISIBLE};
            status = conus_selector_create(&round->ways[w].selector, round->atlas, &how);
        }
    }
    return status;
}

static void round_finish(struct round *round)
{
    for (int w = 0; w < WAYS; w++) {
        way_finish(&round->ways[w]);
    }
    engine_destroy(round->engine);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

static conus_status check_layers(bool *equal, const struct round *round)
{
    struct truth truth = {0};
    size_t firsts = count_other_firsts(&round->ways[1], &round->ways[0]);
    conus_status status = find_truth(&truth, &round->ways[1], round->atlas, &round->scene);
    double cones = (double)round->ways[1].cone_count;
    printf("%zu tori: %.1f in a cone, pierced by %.1f rays each; against all triangles in double %zu of %zu pairs of a "
           "ray and a torus differ, %zu tori are missing; %zu first pieces are not what is visible\n",
           round->scene.count, (double)truth.objects / cones, (double)truth.pierced / (double)truth.objects,
           truth.other_pierced, truth.pierced, truth.lost_objects, firsts);
    *equal = !firsts && !truth.lost_objects && truth.other_pierced <= truth.pierced / 10000;
    return status;
}

static conus_status measure_layers(struct bench *bench, struct round *round)
{
    static const char *const names[WAYS] = {"20000 tori, rays engine, visible", "20000 tori, rays engine, all layers",
                                            "20000 tori, whole query, visible", "20000 tori, whole query, all layers"};
    struct bench_variant variants[WAYS];
    for (int w = 0; w < WAYS; w++) {
        answer_all(&round->ways[w]);
        variants[w] = (struct bench_variant){.name = names[w], .run = answer_all, .data = &round->ways[w]};
        variants[w].equal = !round->ways[w].status;
    }
    bool equal;
    conus_status status = check_layers(&equal, round);
    variants[1].equal = variants[1].equal && equal;
    variants[3].equal = variants[3].equal && equal;
    status =
        status ? status : bench_measure(bench, "layers", variants, WAYS, bench->options.poses, bench->options.angle);
    status = status ? status : bench_ratio(bench, "layers_over_visible", &variants[1], &variants[0]);
    return status ? status : bench_ratio(bench, "layers_over_visible_query", &variants[3], &variants[2]);
}

conus_status bench_layers(struct bench *bench)
{
    static struct round round;
    memset(&round, 0, sizeof round);
    bench->one_thread = true;
    conus_status status = round_init(&round, &bench->options);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", round.engine->name);
        status = measure_layers(bench, &round);
    }
    round_finish(&round);
    return status;
}
