/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of a context volume alone by VTK's volume mappers, beside the colour pass, at the same distance from sample
 * to sample. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/peers/peers.h"
#include "bench/support/bench.h"
#include "bench/support/frame.h"
#include "render/colour/colour.h"
#include "render/colour/colour_gl.h"
#include "render/gl/gl.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN_PART = 35 /* of the width, on all sides */, ENTRIES = 256, WAYS = 5 };

/* The most by which the opacities of pictures may differ (rms): they have 8 bits, and samples at other places along the
 * ray. In a check pictures are a tenth as wide, and edges a larger part of them. */
#define OPACITY_LIMIT 0.02
#define OPACITY_LIMIT_CHECK 0.04

struct scene {
    conus_atlas *atlas;
    conus_renderer *renderer;
    struct target target;
    struct camera camera;
    struct colour_view view;
    float table[ENTRIES][4];
    struct peer_transfer transfer;
    size_t pixels;
    double opacity_limit;
};

struct way {
    const char *what;
    char name[64];
    struct scene *scene;
    struct peer_picture_options options; /* of a peer */
    struct peer_picture *peer;           /* NULL: the colour pass */
    float *rgba;                         /* [pixels][4] */
    conus_status status;
};

static conus_status draw_ours(struct scene *scene)
{
    struct gl_current previous;
    conus_status status = gl_context_use(colour_gl_context(scene->renderer->colour.device), &previous);
    if (!status) {
        target_bind(&scene->target);
        target_clear(&scene->target);
        status = colour_gl_draw(&scene->renderer->colour, &scene->view);
        glFinish();
        gl_current_restore(&previous);
    }
    return status;
}

static void draw_picture(void *data)
{
    struct way *way = data;
    conus_status status = way->peer ? peer_picture_draw(way->peer) : draw_ours(way->scene);
    way->status = status ? status : way->status;
}

static void describe(struct bench_variant *out, const struct way *way, const struct way *ours)
{
    size_t pixels = way->scene->pixels;
    double opacity = picture_rms(way->rgba, ours->rgba, pixels, 3, 3);
    double radiance = picture_rms(way->rgba, ours->rgba, pixels, 0, 2);
    *out = (struct bench_variant){.name = way->name, .run = draw_picture, .data = (void *)way};
    out->equal = opacity <= way->scene->opacity_limit;
    if (way != ours) {
        printf("%s: rms from ours in opacity %.4f (allowed %.2f), in light %.4f of white\n", way->name, opacity,
               way->scene->opacity_limit, radiance);
        out->more = json_pack("{s:f, s:f}", "rms_opacity", opacity, "rms_light", radiance);
    }
}

static conus_status scene_init(struct scene *scene, const struct bench_options *options, const char *transfer)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    const conus_renderer_options renderer = {.transfer = transfer};
    struct gl_current previous;
    conus_status status = atlas_create_empty(&scene->atlas, "no areas");
    status = status ? status : conus_atlas_set_context(scene->atlas, options->context, NULL);
    status = status ? status : conus_renderer_create(&scene->renderer, scene->atlas, &renderer);
    if (status) {
        return status;
    }
    const struct transfer *points = &scene->renderer->transfer;
    transfer_table(&scene->table[0][0], ENTRIES, points);
    for (size_t i = 0; i < ENTRIES; i++) {
        scene->table[i][3] = (float)(1 - exp2(-(double)scene->table[i][3]));
    }
    scene->transfer = (struct peer_transfer){.low = points->points[0].value,
                                             .high = points->points[points->count - 1].value,
                                             .rgba = (const float(*)[4])scene->table,
                                             .count = ENTRIES};
    const struct colour_pass *pass = &scene->renderer->colour;
    uint32_t size[2];
    frame_size(size, options->check);
    const uint32_t edge = size[0] / MARGIN_PART;
    const struct camera_frame frame = {size[0], size[1], edge, edge, edge, edge};
    picture_aim(&scene->camera, &scene->view, &frame, (const double(*)[3])pass->content, pass->content_count,
                options->slices);
    scene->pixels = (size_t)size[0] * size[1];
    scene->opacity_limit = options->check ? OPACITY_LIMIT_CHECK : OPACITY_LIMIT;
    status = gl_context_use(colour_gl_context(scene->renderer->colour.device), &previous);
    if (!status) {
        status = target_init(&scene->target, scene->view.width, scene->view.height, &colour, 1);
        gl_current_restore(&previous);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    struct gl_current previous;
    if (scene->renderer && !gl_context_use(colour_gl_context(scene->renderer->colour.device), &previous)) {
        target_finish(&scene->target);
        gl_current_restore(&previous);
    }
    conus_renderer_destroy(scene->renderer);
    conus_atlas_destroy(scene->atlas);
}

static conus_status make_ways(struct bench *bench, struct scene *scene, struct way ways[WAYS], const char *transfer)
{
    const struct colour_pass *pass = &scene->renderer->colour;
    struct slices slices = colour_pass_slices(pass, &scene->camera, (uint32_t)bench->options.slices);
    conus_status status = CONUS_OK;
    printf("%s: a sample every %.3f mm\n", transfer, slices.spacing);
    for (size_t w = 0; w < WAYS && !status; w++) {
        struct way *way = &ways[w];
        snprintf(way->name, sizeof way->name, "%s: %s", transfer, way->what);
        way->scene = scene;
        way->options.one_thread = bench->one_thread;
        way->options.sample_mm = slices.spacing;
        way->options.size[0] = scene->view.width;
        way->options.size[1] = scene->view.height;
        way->rgba = memory_zeroed(scene->pixels, 4 * sizeof *way->rgba);
        status = way->rgba ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (w && !status) {
            status = peer_picture_create(&way->peer, atlas_context(scene->atlas), &scene->transfer, &scene->camera,
                                         &way->options);
        }
    }
    return status;
}

static conus_status measure_pictures(struct bench *bench, struct way ways[WAYS], const char *suffix)
{
    static const char *const peers[WAYS] = {NULL, "vtkgpu", "vtkgpu_shaded", "vtkfixed", "vtkfixed_shaded"};
    struct bench_variant variants[WAYS];
    struct scene *scene = ways[0].scene;
    struct gl_current previous;
    conus_status status = draw_ours(scene);
    status = status ? status : gl_context_use(colour_gl_context(scene->renderer->colour.device), &previous);
    if (!status) {
        status = target_read(&scene->target, "colour", ways[0].rgba);
        gl_current_restore(&previous);
    }
    for (size_t w = 1; w < WAYS && !status; w++) {
        status = peer_picture_read(ways[w].peer, ways[w].rgba);
    }
    for (size_t w = 0; w < WAYS && !status; w++) {
        describe(&variants[w], &ways[w], &ways[0]);
    }
    status = status ? status : bench_measure(bench, "peers_colour", variants, WAYS, 1, 0);
    for (size_t w = 0; w < WAYS && !status; w++) {
        status = ways[w].status;
    }
    for (size_t w = 1; w < WAYS && !status; w++) {
        char key[64];
        snprintf(key, sizeof key, "%s_over_skipping%s", peers[w], suffix);
        status = bench_ratio(bench, key, &variants[w], &variants[0]);
    }
    return status;
}

/* Everything with one transfer function; `suffix` distinguishes its ratios. */
static conus_status run_transfer(struct bench *bench, const char *transfer, const char *suffix)
{
    struct scene scene = {0};
    struct way ways[WAYS] = {
        {.what = "rays, skipping"},
        {.what = "vtkGPUVolumeRayCastMapper", .options = {.caster = PEER_GPU}},
        {.what = "vtkGPUVolumeRayCastMapper, shaded", .options = {.caster = PEER_GPU, .shade = true}},
        {.what = "vtkFixedPointVolumeRayCastMapper", .options = {.caster = PEER_FIXED_POINT}},
        {.what = "vtkFixedPointVolumeRayCastMapper, shaded", .options = {.caster = PEER_FIXED_POINT, .shade = true}}};
    conus_status status = scene_init(&scene, &bench->options, transfer);
    if (!status) {
        const char *device = conus_renderer_device(scene.renderer);
        bench->one_thread = strstr(device, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%s; %s", peer_version(), device);
        status = make_ways(bench, &scene, ways, transfer);
    }
    status = status ? status : measure_pictures(bench, ways, suffix);
    for (size_t w = 0; w < WAYS; w++) {
        peer_picture_destroy(ways[w].peer);
        memory_free(ways[w].rgba);
    }
    scene_finish(&scene);
    return status;
}

conus_status bench_peers_colour(struct bench *bench)
{
    bench_draw_on_this_thread();
    conus_status status = peer_check_display();
    status = status ? status : run_transfer(bench, "brain", "");
    status = status ? status : run_transfer(bench, "surface", "_surface");
    return status == CONUS_ERROR_GL ? bench_leave_out(bench, "peers_colour") : status;
}
