/* SPDX-License-Identifier: BSD-3-Clause */
/* A labelled volume by OpenGL: the paper's identifier pass, 72 textured slices, against the gl engine. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/bench.h"
#include "bench/support/slice_polygon.h"
#include "bench/support/trace.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/target.h"
#include "render/gl/volume_texture.h"
#include "render/id/slices.h"

#include <stdio.h>
#include <string.h>

enum { RESOLUTION = 16, PIXELS = RESOLUTION * RESOLUTION, SEED = 2010, PLANES = 72 };

/* The paper's pass: slices through the volume, farthest first, each textured, what is no object discarded. */

struct vertex {
    float x, y, depth; /* to the device's right, up and forward, mm */
};

struct slicing {
    struct engine base;
    const struct volume *volume;
    struct gl_context *context;
    struct target target;
    GLuint program, vertices, buffer, texture;
    GLint slope, voxel_from_device;
    struct vertex polygons[PLANES][SLICE_CORNERS];
    float contacts[PIXELS][4];
};

static const char vertex_text[] = "layout(location = 0) in vec3 corner;\n"
                                  "uniform float slope;\n"
                                  "out vec3 place;\n"
                                  "void main()\n"
                                  "{\n"
                                  "    place = corner;\n"
                                  "    gl_Position = vec4(corner.xy / slope, 0.0, corner.z);\n"
                                  "}\n";

static const char fragment_text[] = "in vec3 place;\n"
                                    "layout(binding = 0) uniform usampler3D objects;\n"
                                    "uniform mat4 voxel_from_device;\n"
                                    "layout(location = 0) out uint identifier;\n"
                                    "layout(location = 1) out vec4 contact;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    ivec3 cell = ivec3(floor((voxel_from_device * vec4(place, 1.0)).xyz + 0.5));\n"
                                    "    uint object = is_inside(cell, textureSize(objects, 0)) ? texelFetch(objects, "
                                    "cell, 0).r : 0u;\n"
                                    "    if (object == 0u) {\n"
                                    "        discard;\n"
                                    "    }\n"
                                    "    identifier = object;\n"
                                    "    contact = vec4(place, 1.0);\n"
                                    "}\n";

static conus_status make_slicing(struct slicing *slicing)
{
    static const struct program_source source = {.vertex = {"slices.vert", vertex_text},
                                                 .fragment = {"slices.frag", fragment_text}};
    static const struct target_attachment attachments[] = {{"identifier", TARGET_UINT}, {"contact", TARGET_FLOAT4}};
    const struct volume *volume = slicing->volume;
    uint64_t memory_left = UINT64_MAX;
    conus_status status = program_create(&slicing->program, &source);
    if (status) {
        return status;
    }
    slicing->slope = program_uniform(slicing->program, "slope");
    slicing->voxel_from_device = program_uniform(slicing->program, "voxel_from_device");
    glCreateBuffers(1, &slicing->buffer);
    glNamedBufferData(slicing->buffer, sizeof slicing->polygons, NULL, GL_STREAM_DRAW);
    glCreateVertexArrays(1, &slicing->vertices);
    glVertexArrayVertexBuffer(slicing->vertices, 0, slicing->buffer, 0, sizeof(struct vertex));
    glEnableVertexArrayAttrib(slicing->vertices, 0);
    glVertexArrayAttribFormat(slicing->vertices, 0, 3, GL_FLOAT, GL_FALSE, 0);
    status = volume_texture_create(
        &slicing->texture, volume->objects16 ? VOLUME_TEXTURE_UINT16 : VOLUME_TEXTURE_UINT32, volume->info.dim,
        volume->objects16 ? (const void *)volume->objects16 : volume->objects32, &memory_left);
    status = status ? status : gl_check("slices");
    return status ? status : target_init(&slicing->target, RESOLUTION, RESOLUTION, attachments, 2);
}

/* The slices' polygons, farthest first, and where they are in the volume. */
static size_t cut_slices(struct slicing *slicing, float voxel_from_device[16], const struct cone *cone)
{
    const struct volume *volume = slicing->volume;
    double world_from_eye[16]; /* the device's axes, but looking along z */
    double eye_from_world[16] = {0};
    double matrix[16];
    struct slice_box box;
    size_t count = 0;
    memcpy(world_from_eye, cone->pose.world_from_device, sizeof world_from_eye);
    vec3_scale(world_from_eye + 8, world_from_eye + 8, -1);
    mat4_invert_affine(eye_from_world, world_from_eye);
    for (int n = 0; n < 8; n++) {
        for (int a = 0; a < 3; a++) {
            box.corners[n][a] = (n >> a & 1 ? (double)volume->info.dim[a] : 0) - 0.5;
        }
        mat4_point(box.corners[n], volume->info.world_from_voxel, box.corners[n]);
        mat4_point(box.corners[n], eye_from_world, box.corners[n]);
    }
    struct slices slices =
        slices_over(volume->info.dim, volume->info.world_from_voxel, world_from_eye + 12, world_from_eye + 8, PLANES);
    for (uint32_t k = slices.count; k-- > 0;) {
        double points[SLICE_CORNERS][2];
        double depth = slices_depth(&slices, k);
        if (slice_polygon(points, &box, depth)) {
            for (int i = 0; i < SLICE_CORNERS; i++) {
                slicing->polygons[count][i] = (struct vertex){(float)points[i][0], (float)points[i][1], (float)depth};
            }
            count++;
        }
    }
    mat4_multiply(matrix, volume->voxel_from_world, world_from_eye);
    for (int k = 0; k < 16; k++) {
        voxel_from_device[k] = (float)matrix[k];
    }
    return count;
}

/* Identifiers only: a slice has no voxel, and its distance is the plane's. */
static conus_status trace_slices(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    struct slicing *slicing = (struct slicing *)engine;
    struct gl_current previous;
    float matrix[16];
    GLint first[PLANES];
    GLsizei corners[PLANES];
    conus_status status = gl_context_use(slicing->context, &previous);
    if (status) {
        return status;
    }
    size_t count = cut_slices(slicing, matrix, cone);
    for (size_t k = 0; k < count; k++) {
        first[k] = (GLint)(SLICE_CORNERS * k);
        corners[k] = SLICE_CORNERS;
    }
    glNamedBufferSubData(slicing->buffer, 0, (GLsizeiptr)(count * sizeof slicing->polygons[0]), slicing->polygons);
    target_clear(&slicing->target);
    glUseProgram(slicing->program);
    glUniform1f(slicing->slope, (float)tan(cone->angle / 2));
    glUniformMatrix4fv(slicing->voxel_from_device, 1, GL_FALSE, matrix);
    glBindTextureUnit(0, slicing->texture);
    glBindVertexArray(slicing->vertices);
    glMultiDrawArrays(GL_TRIANGLE_FAN, first, corners, (GLsizei)count);
    status = target_read(&slicing->target, "identifier", out->object);
    status = status ? status : target_read(&slicing->target, "contact", slicing->contacts);
    gl_current_restore(&previous);
    return status;
}

static void destroy_slicing(struct engine *engine)
{
    struct slicing *slicing = (struct slicing *)engine;
    struct gl_current previous;
    if (slicing->context && !gl_context_use(slicing->context, &previous)) {
        target_finish(&slicing->target);
        gl_current_restore(&previous);
    }
    gl_context_destroy(slicing->context); /* and what was made in it */
    memory_free(slicing);
}

static conus_status create_slicing(struct engine **out, const struct volume *volume)
{
    static const struct engine_functions functions = {.trace = trace_slices, .destroy = destroy_slicing};
    struct slicing *slicing = memory_zeroed(1, sizeof *slicing);
    struct gl_current previous;
    if (!slicing) {
        return CONUS_ERROR_MEMORY;
    }
    slicing->base.functions = &functions;
    slicing->volume = volume;
    conus_status status = gl_context_create(&slicing->context, NULL, NULL);
    status = status ? status : gl_context_use(slicing->context, &previous);
    if (!status) {
        status = make_slicing(slicing);
        gl_current_restore(&previous);
    }
    if (status) {
        destroy_slicing(&slicing->base);
        return status;
    }
    *out = &slicing->base;
    return CONUS_OK;
}

enum { SLICES_DRAWN, SLICES_SAMPLED, EXACT, EXACT_RAYS, TRACES, TOGETHER = TRACES, VARIANTS };

struct scene {
    conus_atlas *atlas;
    size_t cone_count;
    struct cone *cones;
    struct engine *engines[TRACES];
    struct trace traces[TRACES];
    struct trace together; /* whose answers are of one trace of all cones */
    struct evidence **out;
    const struct cone **in;
};

static conus_status create_engines(struct scene *scene)
{
    const struct engine_options exact = {0};
    const struct engine_options slices = {.sampling = CONUS_SAMPLING_SLICES, .slices = 5 * PLANES};
    conus_status status = create_slicing(&scene->engines[SLICES_DRAWN], &scene->atlas->volumes[0]);
    status = status ? status : engine_gl_create(&scene->engines[SLICES_SAMPLED], scene->atlas, &slices);
    status = status ? status : engine_gl_create(&scene->engines[EXACT], scene->atlas, &exact);
    return status ? status : engine_rays_create(&scene->engines[EXACT_RAYS], scene->atlas, &exact);
}

static void trace_together(void *data)
{
    struct scene *scene = data;
    struct engine *engine = scene->engines[EXACT];
    conus_status status = engine->functions->trace_many(engine, scene->out, scene->in, scene->cone_count);
    scene->together.status = scene->together.status ? scene->together.status : status;
}

static conus_status make_traces(struct scene *scene)
{
    conus_status status = CONUS_OK;
    for (int i = 0; i < TRACES && !status; i++) {
        status = trace_init(&scene->traces[i], scene->engines[i], scene->cones, scene->cone_count);
    }
    status = status ? status : trace_init(&scene->together, scene->engines[EXACT], scene->cones, scene->cone_count);
    for (size_t i = 0; i < scene->cone_count && !status; i++) {
        scene->in[i] = &scene->cones[i];
        scene->out[i] = &scene->together.answers[i];
        evidence_clear(scene->out[i]);
    }
    return status;
}

static conus_status scene_init(struct scene *scene, const struct bench_options *options)
{
    conus_status status = conus_atlas_load(&scene->atlas, options->atlas, NULL);
    if (!status && !atlas_parcellation(scene->atlas)) {
        status = fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", options->atlas);
    }
    if (status) {
        return status;
    }
    scene->cone_count = options->poses;
    scene->cones = memory_zeroed(options->poses, sizeof *scene->cones);
    scene->in = memory_zeroed(options->poses, sizeof(void *));
    scene->out = memory_zeroed(options->poses, sizeof(void *));
    if (!scene->cones || !scene->in || !scene->out) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(scene->cones, scene->cone_count, &scene->atlas->volumes[0].info, options->angle, SEED);
    status = create_engines(scene);
    return status ? status : make_traces(scene);
}

static void scene_finish(struct scene *scene)
{
    for (int i = 0; i < TRACES; i++) {
        trace_finish(&scene->traces[i]);
        engine_destroy(scene->engines[i]);
    }
    trace_finish(&scene->together);
    memory_free(scene->cones);
    memory_free((void *)scene->in);
    memory_free((void *)scene->out);
    conus_atlas_destroy(scene->atlas);
}

/* Whether drawing slices shows what sampling on the same planes does, but for what single precision moves. */
static bool shows_the_same(const struct trace *drawn, const struct trace *sampled)
{
    return !drawn->status && trace_differences(drawn, sampled) <= trace_pixels(sampled) / 500;
}

static conus_status measure_ways(struct bench *bench, struct scene *scene)
{
    static const char *const names[VARIANTS] = {"72 slices drawn, as in the paper", "gl engine, 72 slices",
                                                "gl engine, exact", "rays engine, exact",
                                                "gl engine, exact, all cones at once"};
    struct bench_variant v[VARIANTS];
    const struct trace *traces = scene->traces;
    trace_together(scene);
    for (int i = 0; i < VARIANTS; i++) {
        v[i] = (struct bench_variant){.name = names[i], .run = trace_all, .data = &scene->traces[i]};
        v[i].other_by_design = i < EXACT;
    }
    v[TOGETHER].run = trace_together;
    v[TOGETHER].data = scene;
    v[SLICES_SAMPLED].equal = v[EXACT_RAYS].equal = true;
    v[SLICES_DRAWN].equal = shows_the_same(&traces[SLICES_DRAWN], &traces[SLICES_SAMPLED]);
    v[EXACT].equal = trace_same(&traces[EXACT], &traces[EXACT_RAYS]);
    v[TOGETHER].equal = trace_same(&scene->together, &traces[EXACT_RAYS]);
    printf("of %zu pixels the exact ones show another object than the rays engine's in %zu, slices in %zu\n",
           trace_pixels(&traces[EXACT]), trace_differences(&traces[EXACT], &traces[EXACT_RAYS]),
           trace_differences(&traces[SLICES_DRAWN], &traces[EXACT_RAYS]));
    conus_status status = bench_measure(bench, "volume_gl", v, VARIANTS, scene->cone_count, bench->options.angle);
    status = status ? status : bench_ratio(bench, "slices72_over_exact", &v[SLICES_DRAWN], &v[EXACT]);
    status = status ? status : bench_ratio(bench, "sampled72_over_exact", &v[SLICES_SAMPLED], &v[EXACT]);
    return status ? status : bench_ratio(bench, "gl_one_over_together", &v[EXACT], &v[TOGETHER]);
}

conus_status bench_volume_gl(struct bench *bench)
{
    struct scene scene = {0};
    bench_draw_on_this_thread();
    conus_status status = scene_init(&scene, &bench->options);
    if (status == CONUS_ERROR_GL) {
        status = bench_leave_out(bench, "volumes by OpenGL");
        scene_finish(&scene);
        return status;
    }
    if (!status) {
        const char *name = scene.engines[EXACT]->name;
        bench->one_thread = strstr(name, "llvmpipe") != NULL;
        snprintf(bench->driver, sizeof bench->driver, "%s", name);
        status = measure_ways(bench, &scene);
    }
    scene_finish(&scene);
    return status;
}
