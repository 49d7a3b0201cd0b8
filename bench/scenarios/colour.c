/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of an atlas in its context: the paper's blending of view-aligned textured slices against the colour pass,
 * which casts rays onto the same planes, without and with skipping of empty bricks. */
#include "bench/bench.h"
#include "bench/support/picture.h"
#include "bench/support/slicing.h"

#include "base/memory.h"
#include "render/gl/shaders.h"
#include "render/gl/target.h"

#include <stdio.h>
#include <string.h>

struct scene {
    conus_atlas *atlas;
    struct picture picture; /* its frame: as the paper had it */
    struct target rays;     /* RGBA float, as pictures have it */
    struct slicing slicing;
    GLuint plain; /* rays that show areas as slices do */
    float *pictures[4];
};

static void blend_slices(void *data)
{
    struct scene *scene = data;
    frame_begin(&scene->picture.frame, false);
    slicing_draw(&scene->slicing, &scene->picture.renderer->colour, &scene->picture.view);
    glFinish();
}

static void cast_rays(struct scene *scene, bool no_skipping)
{
    struct colour_view view = scene->picture.view;
    view.no_skipping = no_skipping;
    target_bind(&scene->rays);
    target_clear(&scene->rays);
    if (colour_pass_draw(&scene->picture.renderer->colour, &view)) {
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

static size_t channels(const struct scene *scene)
{
    return (size_t)scene->picture.view.width * scene->picture.view.height * 4;
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

static conus_status load_scene(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    status = status ? status : conus_atlas_set_context(scene->atlas, options->context, NULL);
    return status ? status : conus_renderer_create(&scene->picture.renderer, scene->atlas, NULL);
}

static conus_status make_scene(struct scene *scene, const struct bench_options *options)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    static const struct program_shader screen = {"screen.vert.glsl", shader_screen_vert};
    const struct colour_view *view = &scene->picture.view;
    conus_status status = load_scene(scene, options);
    if (status) {
        return status;
    }
    picture_aim_at_all(&scene->picture, options, options->slices);
    status = picture_begin(&scene->picture);
    status = status ? status : target_init(&scene->rays, view->width, view->height, &colour, 1);
    status = status ? status : slicing_init(&scene->slicing, view->slices);
    status = status ? status : colour_program_create(&scene->plain, &screen, COLOUR_RAYS_PLAIN);
    return status ? status : make_pictures(scene);
}

static void scene_finish(struct scene *scene)
{
    if (scene->picture.is_current) {
        target_finish(&scene->rays);
        slicing_finish(&scene->slicing);
        glDeleteProgram(scene->plain);
    }
    for (int i = 0; i < 4; i++) {
        memory_free(scene->pictures[i]);
    }
    picture_finish(&scene->picture);
    conus_atlas_destroy(scene->atlas);
}

/* Rays that refine areas' surfaces and their borders, as pictures do, differ from slices; that is only reported. */
static conus_status cast_plain(struct scene *scene, float *picture)
{
    GLuint *program = &scene->picture.renderer->colour.program;
    GLuint usual = *program;
    *program = scene->plain;
    cast_all(scene);
    *program = usual;
    return target_read(&scene->rays, "colour", picture);
}

static conus_status compare_pictures(struct scene *scene, struct bench_variant variants[3])
{
    float **pictures = scene->pictures;
    size_t count = channels(scene);
    blend_slices(scene);
    conus_status status = frame_read(&scene->picture.frame, pictures[0]);
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
    status = status ? status : compare_pictures(&scene, variants);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "gl, %s", conus_renderer_device(scene.picture.renderer));
        status = bench_measure(bench, "colour", variants, 3, 1, 0);
    }
    status = status ? status : bench_ratio(bench, "colour_slicing_over_skipping", &variants[0], &variants[2]);
    status = status ? status : bench_ratio(bench, "colour_all_over_skipping", &variants[1], &variants[2]);
    scene_finish(&scene);
    return status;
}
