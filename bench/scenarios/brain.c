/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's third experiment: frames of a brain of eleven surfaces (234,444 triangles), a pathway and a context, as
 * pictures show it, without and with a selection in each. */
#include "bench/bench.h"
#include "bench/support/picture.h"
#include "bench/support/trace.h"

#include <stdio.h>

enum { CONES = 8, SEED = 11, ENGINES = 2, VARIANTS = 1 + 2 * ENGINES };

struct scene {
    conus_atlas *atlas;
    struct picture picture;
    struct engine *engines[ENGINES]; /* rays, gl */
    struct cone cones[CONES];
    struct trace traces[ENGINES];
};

static conus_status draw_frame(void *data, int way)
{
    const struct picture *picture = &((struct scene *)data)->picture;
    const struct colour_pass *pass = &picture->renderer->colour;
    (void)way;
    conus_status status = colour_pass_begin(pass, &picture->view);
    frame_begin(&picture->frame, false);
    status = status ? status : colour_pass_draw(pass, &picture->view);
    glFlush();
    return status;
}

static conus_status wait_for(void *scene)
{
    (void)scene;
    glFinish();
    return gl_check("brain");
}

static conus_status scene_init(struct scene *scene, const struct bench *bench)
{
    char path[128];
    const struct engine_options how = {0};
    conus_status status = bench_brain(path, sizeof path, bench);
    status = status ? status : conus_atlas_load(&scene->atlas, path, NULL);
    status = status ? status : conus_renderer_create(&scene->picture.renderer, scene->atlas, NULL);
    status = status ? status : engine_rays_create(&scene->engines[0], scene->atlas, &how);
    status = status ? status : engine_gl_create(&scene->engines[1], scene->atlas, &how);
    if (status) {
        return status;
    }
    cones_round_meshes(scene->cones, CONES, scene->atlas, bench->options.angle, SEED);
    for (int e = 0; e < ENGINES && !status; e++) {
        status = trace_init(&scene->traces[e], scene->engines[e], scene->cones, CONES);
    }
    picture_aim_at_all(&scene->picture, &bench->options, 0);
    return status ? status : picture_begin(&scene->picture);
}

static void scene_finish(struct scene *scene)
{
    for (int e = 0; e < ENGINES; e++) {
        trace_finish(&scene->traces[e]);
        engine_destroy(scene->engines[e]);
    }
    picture_finish(&scene->picture);
    conus_atlas_destroy(scene->atlas);
}

static double per_second(const struct bench_variant *variant)
{
    return 1e3 / variant->median_ms;
}

static conus_status measure_frames(struct bench *bench, struct scene *scene)
{
    static const char *const names[VARIANTS] = {"frame", "frame and rays", "frame and gl", "rays alone", "gl alone"};
    static const char *const keys[1 + ENGINES] = {"brain_frames_per_s", "brain_frames_per_s_rays",
                                                  "brain_frames_per_s_gl"};
    struct bench_variant variants[VARIANTS];
    struct shot shots[1 + ENGINES];
    double coverage = 0;
    conus_status status = draw_frame(scene, 0);
    status = status ? status : frame_coverage(&coverage, &scene->picture.frame);
    for (int s = 0; s <= ENGINES; s++) {
        struct trace *trace = s ? &scene->traces[s - 1] : NULL;
        bool equal = coverage >= FRAME_COVERAGE && (!trace || trace_same_but_edges(trace, &scene->traces[0]));
        shots[s] = (struct shot){.draw = draw_frame, .wait = wait_for, .scene = scene, .trace = trace};
        variants[s] = (struct bench_variant){.name = names[s], .run = shoot, .data = &shots[s], .equal = equal};
        if (trace) {
            variants[s + ENGINES] = (struct bench_variant){
                .name = names[s + ENGINES], .run = trace_all, .data = trace, .equal = equal, .per = CONES};
        }
    }
    status = status ? status : bench_measure(bench, "brain", variants, VARIANTS, 1, bench->options.angle);
    for (int s = 0; s <= ENGINES && !status; s++) {
        status = shots[s].status;
        status = status ? status : bench_value(bench, keys[s], per_second(&variants[s]), variants[s].equal);
    }
    status = status ? status : bench_ratio_cold(bench, "brain_rays_over_frame", &variants[3], &variants[0]);
    return status ? status : bench_ratio_cold(bench, "brain_gl_over_frame", &variants[4], &variants[0]);
}

conus_status bench_brain_frames(struct bench *bench)
{
    struct scene scene = {0};
    conus_status status = scene_init(&scene, bench);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "gl, %s; %s", conus_renderer_device(scene.picture.renderer),
                 scene.engines[0]->name);
        status = measure_frames(bench, &scene);
    }
    scene_finish(&scene);
    return status;
}
