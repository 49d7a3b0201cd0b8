/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10) by OpenGL, against what is visible and against the rays engine. */
#include "base/memory.h"
#include "bench/torus/torus_ways.h"
#include "tests/support/gl_edge.h"

#include <stdio.h>
#include <string.h>

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

static conus_status compare_engines(struct comparison *out, const struct layer_way *gl, const struct layer_way *rays,
                                    const conus_atlas *atlas)
{
    enum { BY_RAYS = 1, BY_GL = 2 };
    uint8_t(*has)[TORUS_PIXELS] = memory_raw(atlas->mesh_count, sizeof *has);
    if (!has) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < gl->cone_count; i++) {
        memset(has, 0, atlas->mesh_count * sizeof *has);
        for (size_t s = 0; s < rays->all_hits[i].count; s++) {
            has[rays->all_hits[i].intervals[s].object - 1][rays->all_hits[i].intervals[s].pixel] |= BY_RAYS;
        }
        for (size_t s = 0; s < gl->all_hits[i].count; s++) {
            has[gl->all_hits[i].intervals[s].object - 1][gl->all_hits[i].intervals[s].pixel] |= BY_GL;
        }
        for (uint32_t torus = 0; torus < atlas->mesh_count; torus++) {
            for (uint32_t pixel = 0; pixel < TORUS_PIXELS; pixel++) {
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

static conus_status measure_layers(struct bench *bench, struct layer_round *round)
{
    static const char *const names[LAYER_WAYS] = {
        "20000 tori, rays engine, visible", "20000 tori, rays engine, all layers", "20000 tori, gl engine, visible",
        "20000 tori, gl engine, all layers"};
    struct bench_variant variants[LAYER_WAYS];
    struct comparison comparison = {0};
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < LAYER_WAYS && !status; w++) {
        status = layer_way_init(round, w, w < 2 ? round->rays : round->gl, w % 2);
    }
    if (status) {
        return status;
    }
    layer_round_variants(variants, round, names);
    status = compare_engines(&comparison, &round->ways[3], &round->ways[1], round->atlas);
    printf("of %zu pairs of a ray and a torus one engine only has %zu at edges and %zu elsewhere\n", comparison.pairs,
           comparison.at_edges, comparison.wrong);
    variants[3].equal = variants[3].equal && !comparison.wrong;
    const struct bench_options *options = &bench->options;
    status = status ? status : bench_measure(bench, "gl_layers", variants, LAYER_WAYS, options->poses, options->angle);
    status = status ? status : bench_ratio(bench, "gl_layers_over_gl_visible", &variants[3], &variants[2]);
    return status ? status : bench_ratio(bench, "gl_layers_over_rays_layers", &variants[3], &variants[1]);
}

conus_status bench_gl_layers(struct bench *bench)
{
    struct layer_round round;
    bench_draw_on_this_thread();
    conus_status status = layer_round_init(&round, &bench->options, true);
    if (!status) {
        bench->one_thread = strstr(round.gl->name, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%.60s; %.60s", round.gl->name, round.rays->name);
        status = measure_layers(bench, &round);
    }
    layer_round_finish(&round);
    return status;
}
