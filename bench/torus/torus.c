/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays through 1,000 to 200,000 tori: how the time grows with the number of objects. */
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_pass.h"

#include <stdio.h>
#include <string.h>

enum { WIDTHS = 2, TRACES = WIDTHS + 1, BY_RULE = WIDTHS - 1 };

/* Largest scene that is an atlas, too, whose tori have triangles of their own. */
enum { FLAT_LIMIT = 20000 };

/* Everything about one number of tori: placed, with each number of rays at once, then as an atlas. */
struct round {
    struct torus_scene scene;
    struct cone *cones;
    conus_atlas *atlas; /* NULL beyond FLAT_LIMIT */
    struct mesh_rays *rays;
    struct engine *engines[TRACES];
    struct trace traces[TRACES];
    size_t count;
};

static void round_finish(struct round *round)
{
    for (size_t i = 0; i < TRACES; i++) {
        trace_finish(&round->traces[i]);
        engine_destroy(round->engines[i]);
    }
    mesh_rays_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    memory_free(round->cones);
    torus_scene_finish(&round->scene);
}

static conus_status add_trace(struct round *round, size_t cone_count, const char *how)
{
    struct trace *trace = &round->traces[round->count];
    struct engine *engine = round->engines[round->count++];
    conus_status status = trace_init(trace, engine, round->cones, cone_count);
    snprintf(trace->name, sizeof trace->name, "%zu tori, %s%s", round->scene.count, how,
             round->atlas ? "" : engine->name);
    return status;
}

static conus_status add_placed(struct round *round, size_t cone_count)
{
    static const unsigned widths[WIDTHS] = {1, 0};
    conus_status status = torus_scene_rays(&round->rays, &round->scene);
    for (size_t w = 0; w < WIDTHS && !status; w++) {
        status = mesh_engine_create(&round->engines[w], round->rays, widths[w]);
        status = status ? status : add_trace(round, cone_count, "placed, ");
    }
    return status;
}

static conus_status add_flat(struct round *round, size_t cone_count)
{
    conus_status status = torus_scene_atlas(&round->atlas, &round->scene);
    status = status ? status : engine_rays_create(&round->engines[WIDTHS], round->atlas, &(struct engine_options){0});
    return status ? status : add_trace(round, cone_count, "rays engine");
}

static conus_status round_init(struct round *out, size_t tori, const struct bench_options *options)
{
    conus_status status = torus_scene_init(&out->scene, tori);
    out->cones = status ? NULL : memory_zeroed(options->poses, sizeof *out->cones);
    if (!out->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(out->cones, &out->scene, options->poses, options->angle);
    status = add_placed(out, options->poses);
    return !status && tori <= bench_size(options, FLAT_LIMIT) ? add_flat(out, options->poses) : status;
}

/* An atlas has moved vertices, which are rounded: its tori are not quite the placed ones, and a ray in thousands
 * tells. */
static void fill_in(struct bench_variant *out, struct round *round, size_t index)
{
    struct trace *trace = &round->traces[index];
    size_t differ = trace_differences(trace, &round->traces[0]);
    size_t allowed = index == WIDTHS ? trace_pixels(trace) / 1000 : 0;
    *out = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
    out->equal = !trace->status && differ <= allowed;
    if (differ) {
        printf("%s: %zu of %zu pixels differ\n", trace->name, differ, trace_pixels(trace));
    }
}

static const size_t sizes[] = {1000, 5000, 20000, 200000};
enum { SIZES = sizeof sizes / sizeof sizes[0] };

/* All sizes side by side, since their ratio is wanted. */
static conus_status measure_sizes(struct bench *bench, struct round rounds[SIZES])
{
    struct bench_variant variants[SIZES * TRACES];
    const struct bench_variant *by_rule[SIZES];
    size_t count = 0;
    for (size_t s = 0; s < SIZES; s++) {
        by_rule[s] = &variants[count + BY_RULE];
        for (size_t i = 0; i < rounds[s].count; i++) {
            fill_in(&variants[count++], &rounds[s], i);
        }
    }
    conus_status status = bench_measure(bench, "torus", variants, count, bench->options.poses, bench->options.angle);
    return status ? status : bench_ratio(bench, "rays_200k_over_1k", by_rule[SIZES - 1], by_rule[0]);
}

/* The paper's pass, which draws everything, against the engines, over the angles of cones. */
enum { TORI = 20000, CONES = 4 };

static const double angles[] = {1, 2, 5, 10, 20, 40};
enum { ANGLES = sizeof angles / sizeof angles[0], NARROW = 2, WIDE = 4 /* of 5 and 20 degrees */ };

/* All ways at one angle. The rays come first, with which the others are compared. */
static conus_status measure_angle(struct bench *bench, struct torus_round *round, double angle,
                                  struct bench_variant variants[TORUS_WAYS])
{
    struct cone cones[CONES];
    struct trace traces[TORUS_WAYS] = {0};
    conus_status status = CONUS_OK;
    torus_scene_cones(cones, &round->scene, CONES, angle);
    for (int way = TORUS_WAYS; way-- > 0 && !status;) {
        struct trace *trace = &traces[way];
        status = trace_init(trace, round->engines[way], cones, CONES);
        torus_round_name(trace->name, sizeof trace->name, round, (enum torus_way)way);
        variants[way] = (struct bench_variant){.name = trace->name, .run = trace_all, .data = trace};
        variants[way].equal = !status && trace_same_but_edges(trace, &traces[TORUS_RAYS]);
    }
    status = status ? status : bench_measure(bench, "torus", variants, TORUS_WAYS, CONES, angle);
    for (int way = 0; way < TORUS_WAYS; way++) {
        trace_finish(&traces[way]);
    }
    return status;
}

static conus_status measure_angles(struct bench *bench, struct torus_round *round)
{
    struct bench_variant variants[ANGLES][TORUS_WAYS];
    conus_status status = CONUS_OK;
    for (int a = 0; a < ANGLES && !status; a++) {
        status = measure_angle(bench, round, angles[a], variants[a]);
    }
    const struct bench_variant *narrow = variants[NARROW], *wide = variants[WIDE];
    status = status ? status : bench_ratio(bench, "naive_over_rays", &narrow[TORUS_ALL_DRAWN], &narrow[TORUS_RAYS]);
    status = status ? status : bench_ratio(bench, "naive_over_gl", &narrow[TORUS_ALL_DRAWN], &narrow[TORUS_GL]);
    return status ? status : bench_ratio(bench, "naive_over_gl_20deg", &wide[TORUS_ALL_DRAWN], &wide[TORUS_GL]);
}

static conus_status bench_torus_gl(struct bench *bench)
{
    struct torus_round round;
    bench_draw_on_this_thread();
    conus_status status = torus_round_init(&round, bench_size(&bench->options, TORI), false);
    if (status == CONUS_ERROR_GL) {
        status = bench_leave_out(bench, "torus by OpenGL");
    } else if (!status) {
        const char *gl = round.engines[TORUS_GL]->name;
        bench->one_thread = strstr(gl, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", gl, round.engines[TORUS_RAYS]->name);
        status = measure_angles(bench, &round);
    }
    torus_round_finish(&round);
    return status;
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
        snprintf(bench->driver, sizeof bench->driver, "%s", rounds[0].engines[WIDTHS]->name);
        status = measure_sizes(bench, rounds);
    }
    for (size_t s = 0; s < SIZES; s++) {
        round_finish(&rounds[s]);
    }
    return status ? status : bench_torus_gl(bench);
}
