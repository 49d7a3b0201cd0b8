/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10) by OpenGL, against what is visible and against the rays engine. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/torus/torus_scene.h"
#include "selection/engine/layers.h"
#include "tests/support/gl_edge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION, TORI = 20000, WAYS = 4 };

/* An engine that answers all cones: what is visible, or all layers. */
struct way {
    struct engine *engine;
    const struct cone *cones;
    size_t cone_count;
    struct evidence visible; /* of the last cone */
    struct layers *pieces;   /* [cone_count], or NULL: what is visible */
    conus_status status;
};

static conus_status way_init(struct way *way, struct engine *engine, bool layers, const struct cone *cones,
                             size_t cone_count)
{
    *way = (struct way){.engine = engine, .cones = cones, .cone_count = cone_count};
    way->pieces = layers ? memory_zeroed(cone_count, sizeof *way->pieces) : NULL;
    if (layers && !way->pieces) {
        return CONUS_ERROR_MEMORY;
    }
    return evidence_init(&way->visible, TORUS_RESOLUTION);
}

static void way_finish(struct way *way)
{
    for (size_t i = 0; way->pieces && i < way->cone_count; i++) {
        layers_finish(&way->pieces[i]);
    }
    memory_free(way->pieces);
    evidence_finish(&way->visible);
}

static void answer_all(void *data)
{
    struct way *way = data;
    const struct engine_functions *functions = way->engine->functions;
    for (size_t i = 0; i < way->cone_count; i++) {
        conus_status status = CONUS_OK;
        if (way->pieces) {
            layers_clear(&way->pieces[i]);
            status = functions->pierce(way->engine, &way->pieces[i], &way->cones[i]);
            status = status ? status : layers_sort(&way->pieces[i], PIXELS);
        } else {
            status = functions->look(way->engine, &way->visible, &way->cones[i]);
        }
        way->status = status ? status : way->status;
    }
}

/* ---- Is it right? ------------------------------------------------------------------------------------------- */

struct comparison {
    size_t pairs, at_edges, wrong; /* of a ray and a torus: the rays', and those that one engine has */
};

static bool is_at_edge(const struct cone *cone, const struct mesh *torus, uint32_t pixel)
{
    for (size_t triangle = 0; triangle < torus->triangle_count; triangle++) {
        if (gl_edge_is_near(cone, torus, triangle, pixel)) {
            return true;
        }
    }
    return false;
}

static conus_status compare_engines(struct comparison *out, const struct way *gl, const struct way *rays,
                                    const conus_atlas *atlas)
{
    enum { BY_RAYS = 1, BY_GL = 2 };
    uint8_t(*has)[PIXELS] = memory_raw(atlas->mesh_count, sizeof *has);
    if (!has) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < gl->cone_count; i++) {
        memset(has, 0, atlas->mesh_count * sizeof *has);
        for (size_t s = 0; s < rays->pieces[i].count; s++) {
            has[rays->pieces[i].spans[s].object - 1][rays->pieces[i].spans[s].pixel] |= BY_RAYS;
        }
        for (size_t s = 0; s < gl->pieces[i].count; s++) {
            has[gl->pieces[i].spans[s].object - 1][gl->pieces[i].spans[s].pixel] |= BY_GL;
        }
        for (uint32_t torus = 0; torus < atlas->mesh_count; torus++) {
            for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
                uint8_t by = has[torus][pixel];
                bool apart = by == BY_RAYS || by == BY_GL;
                bool near = apart && is_at_edge(&gl->cones[i], &atlas->meshes[torus], pixel);
                out->pairs += (by & BY_RAYS) != 0;
                out->at_edges += near;
                out->wrong += apart && !near;
            }
        }
    }
    memory_free(has);
    return CONUS_OK;
}

/* ---- The scenario --------------------------------------------------------------------------------------------- */

struct round {
    struct torus_scene scene;
    conus_atlas *atlas;
    struct engine *gl, *rays;
    struct cone *cones;
    struct way ways[WAYS];
};

static conus_status round_init(struct round *round, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&round->scene, bench_size(options, TORI));
    status = status ? status : torus_scene_atlas(&round->atlas, &round->scene);
    status = status ? status : engine_gl_create(&round->gl, round->atlas, &(struct engine_options){0});
    status = status ? status : engine_rays_create(&round->rays, round->atlas, &(struct engine_options){0});
    round->cones = status ? NULL : memory_zeroed(options->poses, sizeof *round->cones);
    if (!round->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(round->cones, &round->scene, options->poses, options->angle);
    for (int w = 0; w < WAYS && !status; w++) {
        struct engine *engine = w < 2 ? round->rays : round->gl;
        status = way_init(&round->ways[w], engine, w % 2, round->cones, options->poses);
    }
    return status;
}

static void round_finish(struct round *round)
{
    for (int w = 0; w < WAYS; w++) {
        way_finish(&round->ways[w]);
    }
    engine_destroy(round->gl);
    engine_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

static conus_status measure_layers(struct bench *bench, struct round *round)
{
    static const char *const names[WAYS] = {"20000 tori, rays engine, visible", "20000 tori, rays engine, all layers",
                                            "20000 tori, gl engine, visible", "20000 tori, gl engine, all layers"};
    struct bench_variant variants[WAYS];
    struct comparison comparison = {0};
    for (int w = 0; w < WAYS; w++) {
        answer_all(&round->ways[w]);
        variants[w] = (struct bench_variant){.name = names[w], .run = answer_all, .data = &round->ways[w]};
        variants[w].equal = !round->ways[w].status;
    }
    conus_status status = compare_engines(&comparison, &round->ways[3], &round->ways[1], round->atlas);
    printf("of %zu pairs of a ray and a torus one engine only has %zu at edges and %zu elsewhere\n", comparison.pairs,
           comparison.at_edges, comparison.wrong);
    variants[3].equal = variants[3].equal && !comparison.wrong;
    const struct bench_options *options = &bench->options;
    status = status ? status : bench_measure(bench, "gl_layers", variants, WAYS, options->poses, options->angle);
    status = status ? status : bench_ratio(bench, "gl_layers_over_gl_visible", &variants[3], &variants[2]);
    return status ? status : bench_ratio(bench, "gl_layers_over_rays_layers", &variants[3], &variants[1]);
}

conus_status bench_gl_layers(struct bench *bench)
{
    static struct round round;
    memset(&round, 0, sizeof round);
    setenv("LP_NUM_THREADS", "0", 0); /* Mesa's llvmpipe stays on this thread, whose time is taken */
    conus_status status = round_init(&round, &bench->options);
    if (!status) {
        bench->one_thread = strstr(round.gl->name, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%.60s; %.60s", round.gl->name, round.rays->name);
        status = measure_layers(bench, &round);
    }
    round_finish(&round);
    return status;
}
