/* SPDX-License-Identifier: BSD-3-Clause */
/* A picture of an atlas in its context: the paper's blending of view-aligned textured slices against the colour pass,
 * which casts rays onto the same planes, without and with skipping of empty bricks. */
#include "apps/bench/bench.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/renderer.h"
#include "render/shaders.h"
#include "render/target.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 1400, HEIGHT = 1050, CHECK_PART = 10, POLYGON = 6 };

/* Of white: how much blended slices may differ from rays that show areas as slices do, by 8 bits of blending: no more
 * than one step. Rays as pictures use them also refine the areas' surface and their borders; that difference is only
 * reported. */
#define RMS_LIMIT (1 / 255.0)

struct vertex {
    float x, y, depth, plane; /* in camera space */
};

struct scene {
    conus_atlas *atlas;
    conus_renderer *renderer;
    struct gl_current previous;
    bool is_current;
    struct camera camera;
    uint32_t width, height, slices;
    struct target rays;               /* RGBA float, as pictures have it */
    GLuint blended, blended_texture;  /* RGBA of 8 bits, as the paper had it */
    GLuint program, buffer, vertices; /* of the slices */
    GLuint plain;                     /* rays that show areas as slices do */
    struct vertex *polygons;          /* [slices][POLYGON], farthest first */
    float *pictures[4];
};

static const char slice_vertex[] = "layout(location = 0) in vec4 corner;\n"
                                   "layout(location = 0) flat out float slice;\n"
                                   "layout(location = 0) uniform vec2 slope;\n"
                                   "void main()\n"
                                   "{\n"
                                   "    slice = corner.w;\n"
                                   "    gl_Position = vec4(corner.xy / slope, 0.0, corner.z);\n"
                                   "}\n";

/* ---- Polygons --------------------------------------------------------------------------------------------------- */

struct box {
    double corners[8][3]; /* camera space, z = depth */
};

/* Around both volumes, along the axes of the areas' grid. */
static void find_box(struct box *out, const struct colour_pass *pass, const struct camera *camera)
{
    double low[3] = {0, 0, 0};
    double high[3] = {1, 1, 1};
    const struct colour_volume *context = &pass->context;
    for (int n = 0; pass->has_context && n < 8; n++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = (n >> a & 1 ? (double)context->dim[a] : 0) - 0.5;
        }
        mat4_point(p, context->world_from_voxel, p);
        mat4_point(p, pass->areas.texture_from_world, p);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], p[a]);
            high[a] = fmax(high[a], p[a]);
        }
    }
    double world_from_texture[16] = {0};
    double camera_from_world[16] = {0};
    mat4_invert_affine(world_from_texture, pass->areas.texture_from_world);
    mat4_invert_affine(camera_from_world, camera->world_from_camera);
    for (int n = 0; n < 8; n++) {
        double *p = out->corners[n];
        for (int a = 0; a < 3; a++) {
            p[a] = n >> a & 1 ? high[a] : low[a];
        }
        mat4_point(p, world_from_texture, p);
        mat4_point(p, camera_from_world, p);
        p[2] = -p[2];
    }
}

/* Puts the points in order around their middle. */
static void sort_around(double (*points)[2], size_t count)
{
    double middle[2] = {0, 0};
    for (size_t i = 0; i < count; i++) {
        middle[0] += points[i][0] / (double)count;
        middle[1] += points[i][1] / (double)count;
    }
    for (size_t i = 1; i < count; i++) {
        for (size_t k = i; k > 0; k--) {
            double a = atan2(points[k - 1][1] - middle[1], points[k - 1][0] - middle[0]);
            double b = atan2(points[k][1] - middle[1], points[k][0] - middle[0]);
            if (a <= b) {
                break;
            }
            double swap[2] = {points[k][0], points[k][1]};
            memcpy(points[k], points[k - 1], sizeof swap);
            memcpy(points[k - 1], swap, sizeof swap);
        }
    }
}

/* Where the plane at `depth` cuts the box: a convex polygon of at most six corners, the last one repeated. */
static void cut(struct vertex out[POLYGON], const struct box *box, double depth, uint32_t plane)
{
    double points[12][2];
    size_t count = 0;
    for (int n = 0; n < 8; n++) {
        for (int a = 0; a < 3; a++) {
            const double *p = box->corners[n];
            const double *q = box->corners[n | 1 << a];
            if (!(n >> a & 1) && (p[2] < depth) != (q[2] < depth)) {
                double part = (depth - p[2]) / (q[2] - p[2]);
                points[count][0] = p[0] + part * (q[0] - p[0]);
                points[count][1] = p[1] + part * (q[1] - p[1]);
                count++;
            }
        }
    }
    sort_around(points, count);
    for (size_t i = 0; i < POLYGON; i++) {
        const double *p = points[i < count ? i : count - 1];
        out[i] = count ? (struct vertex){(float)p[0], (float)p[1], (float)depth, (float)plane} : (struct vertex){0};
    }
}

/* ---- Variants --------------------------------------------------------------------------------------------------- */

static struct colour_view view_of(struct scene *scene, bool no_skipping)
{
    return (struct colour_view){.camera = &scene->camera,
                                .width = scene->width,
                                .height = scene->height,
                                .slices = scene->slices,
                                .no_skipping = no_skipping};
}

static void blend_slices(void *data)
{
    struct scene *scene = data;
    const struct colour_pass *pass = &scene->renderer->colour;
    struct slices slices = colour_pass_slices(pass, &scene->camera, scene->slices);
    struct box box;
    find_box(&box, pass, &scene->camera);
    for (uint32_t n = 0; n < slices.count; n++) {
        uint32_t plane = slices.count - 1 - n;
        cut(scene->polygons + (size_t)n * POLYGON, &box, slices_depth(&slices, plane), plane);
    }
    struct colour_view view = view_of(scene, true);
    colour_pass_prepare(pass, &view);
    target_bind(&scene->rays);
    glBindFramebuffer(GL_FRAMEBUFFER, scene->blended);
    glClearBufferfv(GL_COLOR, 0, (float[]){0, 0, 0, 0});
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(scene->program);
    glUniform2f(0, (float)scene->camera.slope[0], (float)scene->camera.slope[1]);
    glNamedBufferSubData(scene->buffer, 0, (GLsizeiptr)(scene->slices * POLYGON * sizeof *scene->polygons),
                         scene->polygons);
    glBindVertexArray(scene->vertices);
    for (GLint n = 0; n < (GLint)slices.count; n++) {
        glDrawArrays(GL_TRIANGLE_FAN, n * POLYGON, POLYGON);
    }
    glDisable(GL_BLEND);
    glFinish();
}

static void cast_rays(struct scene *scene, bool no_skipping)
{
    struct colour_view view = view_of(scene, no_skipping);
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

static conus_status make_slices(struct scene *scene)
{
    static const struct program_shader vertex = {"slices", slice_vertex};
    scene->polygons = memory_zeroed((size_t)scene->slices * POLYGON, sizeof *scene->polygons);
    if (!scene->polygons) {
        return CONUS_ERROR_MEMORY;
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &scene->blended_texture);
    glTextureStorage2D(scene->blended_texture, 1, GL_RGBA8, (GLsizei)scene->width, (GLsizei)scene->height);
    glCreateFramebuffers(1, &scene->blended);
    glNamedFramebufferTexture(scene->blended, GL_COLOR_ATTACHMENT0, scene->blended_texture, 0);
    glCreateBuffers(1, &scene->buffer);
    glNamedBufferData(scene->buffer, (GLsizeiptr)(scene->slices * POLYGON * sizeof *scene->polygons), NULL,
                      GL_STREAM_DRAW);
    glCreateVertexArrays(1, &scene->vertices);
    glVertexArrayVertexBuffer(scene->vertices, 0, scene->buffer, 0, sizeof *scene->polygons);
    glEnableVertexArrayAttrib(scene->vertices, 0);
    glVertexArrayAttribFormat(scene->vertices, 0, 4, GL_FLOAT, GL_FALSE, 0);
    static const struct program_shader screen = {"screen.vert.glsl", shader_screen_vert};
    conus_status status = colour_program_create(&scene->program, &vertex, COLOUR_SLICES);
    return status ? status : colour_program_create(&scene->plain, &screen, COLOUR_RAYS_PLAIN);
}

static conus_status make_pictures(struct scene *scene)
{
    for (int i = 0; i < 4; i++) {
        scene->pictures[i] = memory_zeroed((size_t)scene->width * scene->height, 4 * sizeof *scene->pictures[i]);
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

static conus_status make_scene(struct scene *scene, const struct bench_options *options)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    uint32_t part = options->check ? CHECK_PART : 1;
    scene->width = WIDTH / part;
    scene->height = HEIGHT / part;
    scene->slices = (uint32_t)options->slices;
    const uint32_t edge = 40 / part;
    const struct camera_frame frame = {scene->width, scene->height, edge, edge, edge, edge};
    conus_status status = load(scene, options);
    status = status ? status : gl_context_use(scene->renderer->context, &scene->previous);
    scene->is_current = !status;
    status = status ? status : target_init(&scene->rays, scene->width, scene->height, &colour, 1);
    status = status ? status : make_slices(scene);
    status = status ? status : make_pictures(scene);
    if (!status) {
        const struct colour_pass *pass = &scene->renderer->colour;
        double forward[3];
        camera_default_forward(forward);
        camera_frame_points(&scene->camera, (const double *)pass->content, pass->content_count, forward,
                            radians_from_degrees(30), &frame);
    }
    return status;
}

static void scene_finish(struct scene *scene)
{
    if (scene->is_current) {
        target_finish(&scene->rays);
        glDeleteTextures(1, &scene->blended_texture);
        glDeleteFramebuffers(1, &scene->blended);
        glDeleteBuffers(1, &scene->buffer);
        glDeleteVertexArrays(1, &scene->vertices);
        glDeleteProgram(scene->program);
        glDeleteProgram(scene->plain);
        gl_current_restore(&scene->previous);
    }
    for (int i = 0; i < 4; i++) {
        memory_free(scene->pictures[i]);
    }
    memory_free(scene->polygons);
    conus_renderer_destroy(scene->renderer);
    conus_atlas_destroy(scene->atlas);
}

/* ---- Answers ---------------------------------------------------------------------------------------------------- */

static size_t channels(const struct scene *scene)
{
    return (size_t)scene->width * scene->height * 4;
}

static double rms(const float *a, const float *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double difference = (double)a[i] - (double)b[i];
        sum += difference * difference;
    }
    return sqrt(sum / (double)count);
}

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
    glGetTextureImage(scene->blended_texture, 0, GL_RGBA, GL_FLOAT, (GLsizei)(count * sizeof(float)), pictures[0]);
    cast_all(scene);
    conus_status status = target_read(&scene->rays, "colour", pictures[1]);
    cast_skipping(scene);
    status = status ? status : target_read(&scene->rays, "colour", pictures[2]);
    status = status ? status : cast_plain(scene, pictures[3]);
    double difference = rms(pictures[0], pictures[3], count);
    bool identical = memcmp(pictures[1], pictures[2], count * sizeof(float)) == 0;
    printf("pictures: skipping and not skipping %s; rms of white between slices and rays on plain areas %.5f (allowed "
           "%.4f), on smooth areas %.3f\n",
           identical ? "identical" : "DIFFER", difference, RMS_LIMIT, rms(pictures[0], pictures[2], count));
    variants[0].equal = variants[1].equal = difference <= RMS_LIMIT;
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
        snprintf(bench->driver, sizeof bench->driver, "%s", conus_renderer_device(scene.renderer));
        status = bench_measure(bench, "colour", variants, 3, 1, 0);
    }
    status = status ? status : bench_ratio(bench, "colour_slicing_over_skipping", &variants[0], &variants[2]);
    status = status ? status : bench_ratio(bench, "colour_all_over_skipping", &variants[1], &variants[2]);
    scene_finish(&scene);
    return status;
}
