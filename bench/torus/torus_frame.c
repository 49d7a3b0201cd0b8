/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's first experiment: the frame rate of 1,000 to 20,000 tori without and with a selection in every frame. */
#include "bench/support/bench.h"
#include "bench/support/frame.h"
#include "bench/support/trace.h"
#include "bench/torus/torus.h"
#include "selection/engine/triangles/mesh_tracer.h"

#include <stdio.h>
#include <string.h>

enum { CONES = 4 };

/* A frame alone, a frame and one selection, selections alone. */
enum { FRAME, FRAME_AND, ALONE = FRAME_AND + TORUS_WAYS, VARIANTS = ALONE + TORUS_WAYS };

/* One number of tori. */
struct scene {
    struct torus_round round;
    uint32_t size[2];
    struct cone cones[CONES];
    struct trace traces[TORUS_WAYS];
};

static conus_status draw_frame(void *data, int way)
{
    struct scene *scene = data;
    (void)way;
    return torus_pass_frame(scene->round.pass, scene->size);
}

static conus_status wait_for(void *data)
{
    return torus_pass_wait(((struct scene *)data)->round.pass);
}

static conus_status scene_init(struct scene *scene, const struct bench *bench, size_t tori, bool placed)
{
    frame_size(scene->size, bench->options.check);
    conus_status status = torus_round_init(&scene->round, tori, placed);
    if (!status) {
        torus_scene_cones(scene->cones, &scene->round.scene, CONES, bench->options.angle);
    }
    for (int way = 0; way < TORUS_WAYS && !status; way++) {
        struct engine *engine = scene->round.engines[way];
        struct trace *trace = &scene->traces[way];
        status = engine ? trace_init(trace, engine, scene->cones, CONES) : CONUS_OK;
        torus_round_name(trace->name, sizeof trace->name, &scene->round, (enum torus_way)way);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    for (int way = 0; way < TORUS_WAYS; way++) {
        trace_finish(&scene->traces[way]);
    }
    torus_round_finish(&scene->round);
}

/* Measures one number of tori, and fills in the variants that it has: with more tori than the paper's there is no frame
 * with a selection. */
static conus_status measure_scene(struct bench *bench, struct scene *scene, struct bench_variant out[VARIANTS])
{
    struct shot shots[1 + TORUS_WAYS] = {{.draw = draw_frame, .wait = wait_for, .scene = scene}};
    struct bench_variant variants[VARIANTS];
    char names[TORUS_WAYS][144];
    int place[VARIANTS];
    size_t count = 0;
    double coverage = 0;
    conus_status status = torus_pass_frame(scene->round.pass, scene->size);
    status = status ? status : torus_pass_coverage(&coverage, scene->round.pass);
    printf("%zu tori cover %.0f %% of a frame\n", scene->round.scene.count, 100 * coverage);
    bool shown = !status && coverage >= FRAME_COVERAGE;
    variants[count] = (struct bench_variant){.name = "colour", .run = shoot, .data = &shots[0], .equal = shown};
    place[count++] = FRAME;
    for (int way = 0; way < TORUS_WAYS; way++) {
        struct trace *trace = &scene->traces[way];
        if (trace->engine) {
            bool equal = trace_same_but_edges(trace, &scene->traces[TORUS_RAYS]);
            shots[1 + way] = (struct shot){.draw = draw_frame, .wait = wait_for, .scene = scene, .trace = trace};
            snprintf(names[way], sizeof names[way], "%s, in a frame", trace->name);
            if (!scene->round.rays) {
                variants[count] = (struct bench_variant){
                    .name = names[way], .run = shoot, .data = &shots[1 + way], .equal = shown && equal};
                place[count++] = FRAME_AND + way;
            }
            variants[count] = (struct bench_variant){
                .name = trace->name, .run = trace_all, .data = trace, .equal = equal, .per = CONES};
            place[count++] = ALONE + way;
        }
    }
    char colour[64];
    snprintf(colour, sizeof colour, "%zu tori, colour frame", scene->round.scene.count);
    variants[0].name = colour;
    status = status ? status : bench_measure(bench, "torus_frame", variants, count, 1, bench->options.angle);
    for (size_t i = 0; i < count; i++) {
        out[place[i]] = variants[i];
    }
    return status;
}

static conus_status run_count(struct bench *bench, size_t tori, bool placed, struct bench_variant out[VARIANTS])
{
    struct scene scene = {0};
    conus_status status = scene_init(&scene, bench, tori, placed);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "gl, %s; %s", torus_pass_device(scene.round.pass),
                 placed ? scene.round.rays->tracer->name : scene.round.engines[TORUS_RAYS]->name);
        status = measure_scene(bench, &scene, out);
    }
    scene_finish(&scene);
    return status;
}

/* A selection as a part of a frame, in the paper's largest scene. */
static conus_status add_ratios(struct bench *bench, const struct bench_variant v[VARIANTS])
{
    const struct bench_variant *frame = &v[FRAME];
    conus_status status = bench_ratio(bench, "id_over_colour_naive", &v[ALONE + TORUS_ALL_DRAWN], frame);
    status = status ? status : bench_ratio(bench, "id_over_colour_gl", &v[ALONE + TORUS_GL], frame);
    return status ? status : bench_ratio(bench, "id_over_colour_rays", &v[ALONE + TORUS_RAYS], frame);
}

conus_status bench_torus_frame(struct bench *bench)
{
    static const size_t counts[] = {1000, 2000, 5000, 10000, 20000, 200000};
    enum { COUNTS = sizeof counts / sizeof counts[0], PAPER = COUNTS - 2 };
    struct bench_variant variants[VARIANTS];
    conus_status status = CONUS_OK;
    for (int i = 0; i < COUNTS && !status; i++) {
        size_t tori = bench_size(&bench->options, counts[i]);
        status = run_count(bench, bench->options.check && i > PAPER ? 2 * tori / 10 : tori, i > PAPER, variants);
        status = !status && i == PAPER ? add_ratios(bench, variants) : status;
    }
    return status;
}
