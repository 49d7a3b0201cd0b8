/* SPDX-License-Identifier: BSD-3-Clause */
/* Rays through 1,000 to 200,000 tori: how the time grows with the number of objects. */
#include "bench/torus/torus.h"
#include "base/memory.h"
#include "bench/support/bench.h"
#include "bench/support/trace.h"

#include <stdio.h>
#include <string.h>

/* The ways at one number of tori: one torus at all places, by single rays, by packets and by the engine's rule; then an
 * atlas of up to FLAT_LIMIT tori with triangles of their own. */
enum { SINGLE, PACKETS, BY_RULE, FLAT, WAYS, FLAT_LIMIT = 20000 };

struct round {
    struct torus_scene scene;
    struct mesh_rays *rays;
    struct contest contest;
};

static conus_status round_init(struct round *out, size_t tori, const struct bench_options *options)
{
    struct contest *contest = &out->contest;
    static const unsigned widths[FLAT] = {1, 16, 0};
    char name[112];
    contest->cone_count = options->poses;
    conus_status status = torus_scene_init(&out->scene, tori);
    status = status ? status : torus_scene_rays(&out->rays, &out->scene);
    contest->cones = status ? NULL : memory_zeroed(options->poses, sizeof *contest->cones);
    if (!contest->cones) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    torus_scene_cones(contest->cones, &out->scene, options->poses, options->angle);
    for (unsigned way = SINGLE; way < FLAT && !status; way++) {
        struct engine *engine = NULL;
        status = mesh_engine_create(&engine, out->rays, widths[way]);
        if (!status) {
            snprintf(name, sizeof name, "%zu tori, placed, %s", tori, engine->name);
            status = contest_add(contest, engine, name);
        }
    }
    if (!status && tori <= bench_size(options, FLAT_LIMIT)) {
        struct engine *engine = NULL;
        status = torus_scene_atlas(&contest->atlas, &out->scene);
        status = status ? status : engine_rays_create(&engine, contest->atlas, &(struct engine_options){0});
        snprintf(name, sizeof name, "%zu tori, rays engine", tori);
        status = status ? status : contest_add(contest, engine, name);
    }
    return status;
}

/* An atlas has moved vertices, which are rounded: its tori are not quite the placed ones, so that one ray in thousands
 * differs. */
static struct bench_variant compare(struct round *round, size_t way)
{
    struct bench_variant out = contest_variant(&round->contest, way);
    const struct trace *trace = &round->contest.traces[way];
    size_t differ = trace_differences(trace, &round->contest.traces[SINGLE]);
    out.equal = !trace->status && differ <= (way == FLAT ? trace_pixels(trace) / 1000 : 0);
    if (differ) {
        printf("%s: %zu of %zu pixels differ\n", trace->name, differ, trace_pixels(trace));
    }
    return out;
}

static const size_t sizes[] = {1000, 5000, 20000, 200000};
enum { SIZES = sizeof sizes / sizeof sizes[0] };

/* Measures all sizes side by side, since their ratio is wanted. */
static conus_status measure_sizes(struct bench *bench, struct round rounds[SIZES])
{
    struct bench_variant variants[SIZES * WAYS];
    const struct bench_variant *by_rule[SIZES];
    size_t count = 0;
    for (size_t s = 0; s < SIZES; s++) {
        by_rule[s] = &variants[count + BY_RULE];
        for (size_t i = 0; i < rounds[s].contest.count; i++) {
            variants[count++] = compare(&rounds[s], i);
        }
    }
    conus_status status = bench_measure(bench, "torus", variants, count, bench->options.poses, bench->options.angle);
    return status ? status : bench_ratio(bench, "rays_200k_over_1k", by_rule[SIZES - 1], by_rule[0]);
}

/* The paper's pass, which draws everything, against the engines, over the angles of cones. */
enum { TORI = 20000, CONES = 4 };

static const double angles[] = {1, 2, 5, 10, 20, 40};
enum { ANGLES = sizeof angles / sizeof angles[0], NARROW = 2, WIDE = 4 /* of 5 and 20 degrees */ };

/* Measures all ways at one angle. The rays come first; the others are compared with them. */
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

static conus_status bench_torus_gl(struct bench *bench)
{
    struct torus_round round;
    struct bench_variant variants[ANGLES][TORUS_WAYS];
    const struct bench_variant *narrow = variants[NARROW], *wide = variants[WIDE];
    bench_draw_on_this_thread();
    conus_status status = torus_round_init(&round, bench_size(&bench->options, TORI), false);
    if (status == CONUS_ERROR_GL) {
        status = bench_leave_out(bench, "torus by OpenGL");
    } else if (!status) {
        const char *gl = round.engines[TORUS_GL]->name;
        bench->one_thread = strstr(gl, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", gl, round.engines[TORUS_RAYS]->name);
        for (int a = 0; a < ANGLES && !status; a++) {
            status = measure_angle(bench, &round, angles[a], variants[a]);
        }
        status = status ? status : bench_ratio(bench, "naive_over_rays", &narrow[TORUS_ALL_DRAWN], &narrow[TORUS_RAYS]);
        status = status ? status : bench_ratio(bench, "naive_over_gl", &narrow[TORUS_ALL_DRAWN], &narrow[TORUS_GL]);
        status = status ? status : bench_ratio(bench, "naive_over_gl_20deg", &wide[TORUS_ALL_DRAWN], &wide[TORUS_GL]);
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
        snprintf(bench->driver, sizeof bench->driver, "%s", rounds[0].contest.engines[FLAT]->name);
        status = measure_sizes(bench, rounds);
    }
    for (size_t s = 0; s < SIZES; s++) {
        contest_finish(&rounds[s].contest);
        mesh_rays_destroy(rounds[s].rays);
        torus_scene_finish(&rounds[s].scene);
    }
    return status ? status : bench_torus_gl(bench);
}
