/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of an atlas in its context: the paper's blending of view-aligned textured slices against the colour pass,
 * which casts rays onto the same planes, without and with skipping of empty bricks. */
#include "bench/bench.h"
#include "bench/scenarios/frame.h"
#include "bench/scenarios/slicing.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/colour/renderer.h"
#include "render/gl/shaders.h"
#include "render/gl/target.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN_PART = 35 }; /* of the picture's width, on all sides */

struct scene {
    conus_atlas *atlas;
    conus_renderer *renderer;
    struct gl_current previous;
    bool is_current;
    struct camera camera;
    struct colour_view view;
    struct target rays;   /* RGBA float, as pictures have it */
    struct frame blended; /* as the paper had it             */
    struct slicing slicing;
    GLuint plain; /* rays that show areas as slices do */
    float *pictures[4];
};

/* ---- Variants --------------------------------------------------------------------------------------------------- */

static void blend_slices(void *data)
{
    struct scene *scene = data;
    frame_begin(&scene->blended, false);
    slicing_draw(&scene->slicing, &scene->renderer->colour, &scene->view);
    glFinish();
}

static void cast_rays(struct scene *scene, bool no_skipping)
{
    struct colour_view view = scene->view;
    view.no_skipping = no_skipping;
    target_bind(&scene->rays);
    target_clear(&scene->rays);
    if (colour_pass_draw(&scene->renderer->colour, &view)) {
        fprintf(stderr, "%s\n", conus_message());
    }
    glFinish();
}

static void cast_all(void *data)
{
    cast_rays(data, true);
}

static void cast_skipping(void *data)
{
    cast_rays(data, false);
}

/* ---- Scene ------------------------------------------------------------------------------------------------------ */

static size_t channels(const struct scene *scene)
{
    return (size_t)scene->view.width * scene->view.height * 4;
}

static conus_status make_pictures(struct scene *scene)
{
    for (int i = 0; i < 4; i++) {
        scene->pictures[i] = memory_zeroed(channels(scene), sizeof *scene->pictures[i]);
        if (!scene->pictures[i]) {
            return CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

static conus_status load(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    status = status ? status : conus_atlas_set_context(scene->atlas, options->context, NULL);
    return status ? status : conus_renderer_create(&scene->renderer, scene->atlas, NULL);
}

static void aim(struct scene *scene, const struct bench_options *options)
{
    const struct colour_pass *pass = &scene->renderer->colour;
    uint32_t size[2];
    double forward[3];
    frame_size(size, options->check);
    uint32_t margin = size[0] / MARGIN_PART;
    const struct camera_frame frame = {size[0], size[1], margin, margin, margin, margin};
    camera_default_forward(forward);
    camera_frame_points(&scene->camera, (const double *)pass->content, pass->content_count, forward,
                        radians_from_degrees(30), &frame);
    scene->view = (struct colour_view){
        .camera = &scene->camera, .width = size[0], .height = size[1], .slices = (uint32_t)options->slices};
}

static conus_status make_scene(struct scene *scene, const struct bench_options *options)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    static const struct program_shader screen = {"screen.vert.glsl", shader_screen_vert};
    conus_status status = load(scene, options);
    status = status ? status : gl_context_use(scene->renderer->context, &scene->previous);
    scene->is_current = !status;
    if (status) {
        return status;
    }
    aim(scene, options);
    const uint32_t size[2] = {scene->view.width, scene->view.height};
    status = target_init(&scene->rays, size[0], size[1], &colour, 1);
    status = status ? status : frame_resize(&scene->blended, size);
    status = status ? status : slicing_init(&scene->slicing, scene->view.slices);
    status = status ? status : colour_program_create(&scene->plain, &screen, COLOUR_RAYS_PLAIN);
    return status ? status : make_pictures(scene);
}

static void scene_finish(struct scene *scene)
{
    if (scene->is_current) {
        target_finish(&scene->rays);
        frame_finish(&scene->blended);
        slicing_finish(&scene->slicing);
        glDeleteProgram(scene->plain);
        gl_current_restore(&scene->previous);
    }
    for (int i = 0; i < 4; i++) {
        memory_free(scene->pictures[i]);
    }
    conus_renderer_destroy(scene->renderer);
    conus_atlas_destroy(scene->atlas);
}

/* ---- Answers ---------------------------------------------------------------------------------------------------- */

/* Rays that refine areas' surfaces and their borders, as pictures do, differ from slices; that is only reported. */
static conus_status cast_plain(struct scene *scene, float *picture)
{
    GLuint *program = &scene->renderer->colour.program;
    GLuint usual = *program;
    *program = scene->plain;
    cast_all(scene);
    *program = usual;
    return target_read(&scene->rays, "colour", picture);
}

static conus_status compare(struct scene *scene, struct bench_variant variants[3])
{
    float **pictures = scene->pictures;
    size_t count = channels(scene);
    blend_slices(scene);
    conus_status status = frame_read(&scene->blended, pictures[0]);
    cast_all(scene);
    status = status ? status : target_read(&scene->rays, "colour", pictures[1]);
    cast_skipping(scene);
    status = status ? status : target_read(&scene->rays, "colour", pictures[2]);
    status = status ? status : cast_plain(scene, pictures[3]);
    double difference = picture_rms(pictures[0], pictures[3], count);
    bool identical = memcmp(pictures[1], pictures[2], count * sizeof(float)) == 0;
    printf("pictures: skipping and not skipping %s; rms of white between slices and rays on plain areas %.5f (allowed "
           "%.4f), on smooth areas %.3f\n",
           identical ? "identical" : "DIFFER", difference, PICTURE_RMS_LIMIT,
           picture_rms(pictures[0], pictures[2], count));
    variants[0].equal = variants[1].equal = difference <= PICTURE_RMS_LIMIT;
    variants[2].equal = variants[1].equal && identical;
    return status ? status : gl_check("bench");
}

conus_status bench_colour(struct bench *bench)
{
    struct scene scene = {0};
    struct bench_variant variants[] = {{.name = "slices, blended", .run = blend_slices, .data = &scene},
                                       {.name = "rays, all samples", .run = cast_all, .data = &scene},
                                       {.name = "rays, skipping", .run = cast_skipping, .data = &scene}};
    conus_status status = make_scene(&scene, &bench->options);
    status = status ? status : compare(&scene, variants);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "gl, %s", conus_renderer_device(scene.renderer));
        status = bench_measure(bench, "colour", variants, 3, 1, 0);
    }
    status = status ? status : bench_ratio(bench, "colour_slicing_over_skipping", &variants[0], &variants[2]);
    status = status ? status : bench_ratio(bench, "colour_all_over_skipping", &variants[1], &variants[2]);
    scene_finish(&scene);
    return status;
}
