/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene by OpenGL: the paper's pass, which draws everything, against the engines, over cones' angles. */
#include "bench/bench.h"
#include "bench/support/trace.h"
#include "bench/torus/torus_pass.h"

#include <stdio.h>
#include <string.h>

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

conus_status bench_torus_gl(struct bench *bench)
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
