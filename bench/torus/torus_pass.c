/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the torus scene with OpenGL as the paper does, and creates the engines of one number of tori. */
#include "bench/torus/torus.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/frame.h"
#include "bench/support/trace.h"
#include "render/gl/gl.h"

#include <stdio.h>
#include <string.h>

enum { PIXELS = TORUS_RESOLUTION * TORUS_RESOLUTION };

struct torus_pass {
    struct gl_context *context;
    double side; /* of the cube of tori, mm */
    GLuint identify, paint;
    GLint identify_matrix, paint_matrix, paint_eye;
    GLuint vertices, corner_buffer, index_buffer, place_buffer;
    GLsizei index_count, count;
    struct target buffer;
    struct frame frame;
    float contacts[PIXELS][4];
};

static const char place_vert[] = "layout(location = 0) in vec3 corner;\n"
                                 "layout(location = 1) in mat4 world_from_torus;\n"
                                 "uniform mat4 clip_from_world;\n"
                                 "out vec3 place;\n"
                                 "#if PAINT\n"
                                 "out vec3 normal;\n"
                                 "#endif\n"
                                 "flat out uint number;\n"
                                 "void main()\n"
                                 "{\n"
                                 "    vec4 p = world_from_torus * vec4(corner, 1.0);\n"
                                 "    place = p.xyz;\n"
                                 "#if PAINT\n"
                                 "    vec3 ring = vec3(3.5 * normalize(corner.xy), 0.0);\n"
                                 "    normal = mat3(world_from_torus) * (corner - ring);\n"
                                 "    number = uint(gl_InstanceID);\n"
                                 "#else\n"
                                 "    number = 1u + uint(gl_InstanceID);\n"
                                 "#endif\n"
                                 "    gl_Position = clip_from_world * p;\n"
                                 "}\n";

static const char identify_frag[] = "in vec3 place;\n"
                                    "flat in uint number;\n"
                                    "layout(location = 0) out uint identifier;\n"
                                    "layout(location = 1) out vec4 contact;\n"
                                    "void main()\n"
                                    "{\n"
                                    "    identifier = number;\n"
                                    "    contact = vec4(place, 1.0);\n"
                                    "}\n";

/* Phong shading with the light at the eye; a colour per torus. */
static const char paint_frag[] = "in vec3 place;\n"
                                 "in vec3 normal;\n"
                                 "flat in uint number;\n"
                                 "uniform vec3 eye;\n"
                                 "layout(location = 0) out vec4 colour;\n"
                                 "void main()\n"
                                 "{\n"
                                 "    vec3 n = normalize(normal);\n"
                                 "    vec3 v = normalize(eye - place);\n"
                                 "    float cosine = max(dot(n, v), 0.0);\n"
                                 "    float shine = pow(max(2.0 * cosine * cosine - 1.0, 0.0), 32.0);\n"
                                 "    vec3 own = vec3(number & 7u, number >> 3u & 7u, number >> 6u & 7u) / 7.0;\n"
                                 "    colour = vec4(own * (0.2 + 0.8 * cosine) + 0.3 * shine, 1.0);\n"
                                 "}\n";

static conus_status upload_places(struct torus_pass *pass, const struct torus_scene *scene)
{
    float(*places)[16] = memory_raw(scene->count, sizeof *places);
    if (!places) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < 16 * scene->count; i++) {
        places[i / 16][i % 16] = (float)scene->places[i / 16][i % 16];
    }
    glCreateBuffers(1, &pass->place_buffer);
    glNamedBufferStorage(pass->place_buffer, (GLsizeiptr)(scene->count * sizeof *places), places, 0);
    memory_free(places);
    return CONUS_OK;
}

static void make_vertices(struct torus_pass *pass, const struct mesh *torus)
{
    glCreateBuffers(1, &pass->corner_buffer);
    glNamedBufferStorage(pass->corner_buffer, (GLsizeiptr)(12 * torus->vertex_count), torus->positions, 0);
    glCreateBuffers(1, &pass->index_buffer);
    glNamedBufferStorage(pass->index_buffer, (GLsizeiptr)(12 * torus->triangle_count), torus->triangles, 0);
    glCreateVertexArrays(1, &pass->vertices);
    glVertexArrayVertexBuffer(pass->vertices, 0, pass->corner_buffer, 0, 12);
    glVertexArrayVertexBuffer(pass->vertices, 1, pass->place_buffer, 0, 64);
    glVertexArrayElementBuffer(pass->vertices, pass->index_buffer);
    glVertexArrayBindingDivisor(pass->vertices, 1, 1);
    for (GLuint k = 0; k < 5; k++) {
        glEnableVertexArrayAttrib(pass->vertices, k);
        glVertexArrayAttribFormat(pass->vertices, k, k ? 4 : 3, GL_FLOAT, GL_FALSE, k ? 16 * (k - 1) : 0);
        glVertexArrayAttribBinding(pass->vertices, k, k ? 1 : 0);
    }
    pass->index_count = (GLsizei)(3 * torus->triangle_count);
}

static conus_status make_programs(struct torus_pass *pass)
{
    const struct program_define painting = {"PAINT", 1}, identifying = {"PAINT", 0};
    const struct program_source identify = {.vertex = {"place.vert", place_vert},
                                            .fragment = {"identify.frag", identify_frag},
                                            .defines = &identifying,
                                            .define_count = 1};
    const struct program_source paint = {.vertex = {"place.vert", place_vert},
                                         .fragment = {"paint.frag", paint_frag},
                                         .defines = &painting,
                                         .define_count = 1};
    conus_status status = program_create(&pass->identify, &identify);
    status = status ? status : program_create(&pass->paint, &paint);
    if (!status) {
        pass->identify_matrix = program_uniform(pass->identify, "clip_from_world");
        pass->paint_matrix = program_uniform(pass->paint, "clip_from_world");
        pass->paint_eye = program_uniform(pass->paint, "eye");
    }
    return status;
}

static void destroy_pass(struct torus_pass *pass)
{
    struct gl_current previous;
    if (!pass) {
        return;
    }
    if (pass->context && !gl_context_use(pass->context, &previous)) {
        target_finish(&pass->buffer);
        frame_finish(&pass->frame);
        gl_current_restore(&previous);
    }
    gl_context_destroy(pass->context); /* and what was made in it */
    memory_free(pass);
}

static conus_status create_pass(struct torus_pass **out, const struct torus_scene *scene)
{
    static const struct target_attachment attachments[] = {
        {"identifier", TARGET_UINT}, {"contact", TARGET_FLOAT4}, {"depth", TARGET_DEPTH}};
    struct torus_pass *pass = memory_zeroed(1, sizeof *pass);
    struct gl_current previous;
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = gl_context_create(&pass->context, NULL, NULL);
    status = status ? status : gl_context_use(pass->context, &previous);
    if (!status) {
        pass->side = scene->side;
        pass->count = (GLsizei)scene->count;
        status = make_programs(pass);
        status = status ? status : upload_places(pass, scene);
        if (!status) {
            make_vertices(pass, &scene->torus);
            status = gl_check("tori");
        }
        status = status ? status : target_init(&pass->buffer, TORUS_RESOLUTION, TORUS_RESOLUTION, attachments, 3);
        gl_current_restore(&previous);
    }
    if (status) {
        destroy_pass(pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

const char *torus_pass_device(const struct torus_pass *pass)
{
    return gl_context_renderer(pass->context);
}

/* The matrix of a view; the slopes are tangents of half its angles. */
static void clip_matrix(float out[16], const double world_from_camera[16], const double slope[2])
{
    const double near = 0.1;
    const double far = 1e4;
    double m[16] = {0};
    mat4_invert_affine(m, world_from_camera);
    for (int column = 0; column < 4; column++) {
        const double *v = m + 4 * column;
        double w = column == 3;
        out[4 * column] = (float)(v[0] / slope[0]);
        out[4 * column + 1] = (float)(v[1] / slope[1]);
        out[4 * column + 2] = (float)(-v[2] * (far + near) / (far - near) - 2 * w * far * near / (far - near));
        out[4 * column + 3] = (float)-v[2];
    }
}

struct pass_engine {
    struct engine base;
    struct torus_pass *pass;
};

static conus_status trace_by_drawing(struct engine *engine, struct evidence *out, const struct cone *cone)
{
    const struct pass_engine *own = (struct pass_engine *)engine;
    struct torus_pass *pass = own->pass;
    struct gl_current previous;
    float matrix[16];
    double slope = tan(cone->angle / 2);
    conus_status status = gl_context_use(pass->context, &previous);
    if (status) {
        return status;
    }
    clip_matrix(matrix, cone->pose.world_from_device, (double[]){slope, slope});
    target_clear(&pass->buffer);
    glUseProgram(pass->identify);
    glUniformMatrix4fv(pass->identify_matrix, 1, GL_FALSE, matrix);
    glBindVertexArray(pass->vertices);
    glDrawElementsInstanced(GL_TRIANGLES, pass->index_count, GL_UNSIGNED_INT, NULL, pass->count);
    status = target_read(&pass->buffer, "identifier", out->object);
    status = status ? status : target_read(&pass->buffer, "contact", pass->contacts);
    gl_current_restore(&previous);
    return status;
}

static void destroy(struct engine *engine)
{
    memory_free(engine);
}

/* The paper's ID pass as an engine: identifier and contact of every torus into 16 x 16 pixels, both read back. All tori
 * are instances of one draw call. To be destroyed before the pass. */
static conus_status create_pass_engine(struct engine **out, struct torus_pass *pass)
{
    static const struct engine_functions functions = {.trace = trace_by_drawing, .destroy = destroy};
    struct pass_engine *engine = memory_zeroed(1, sizeof *engine);
    if (!engine) {
        return CONUS_ERROR_MEMORY;
    }
    *engine = (struct pass_engine){{&functions, ""}, pass};
    *out = &engine->base;
    return CONUS_OK;
}

/* The eye is beyond a corner of the cube, all of which is in view. */
static void draw_frame(struct torus_pass *pass)
{
    const double eye[3] = {0.9 * pass->side, 0.7 * pass->side, 1.6 * pass->side};
    const double middle[3] = {0, 0, 0};
    const double slope[2] = {0.5 * pass->frame.width / pass->frame.height, 0.5};
    float matrix[16];
    conus_pose pose;
    if (conus_pose_toward(&pose, eye, middle, NULL)) {
        return;
    }
    clip_matrix(matrix, pose.world_from_device, slope);
    frame_begin(&pass->frame, true);
    glUseProgram(pass->paint);
    glUniformMatrix4fv(pass->paint_matrix, 1, GL_FALSE, matrix);
    glUniform3f(pass->paint_eye, (float)eye[0], (float)eye[1], (float)eye[2]);
    glBindVertexArray(pass->vertices);
    glDrawElementsInstanced(GL_TRIANGLES, pass->index_count, GL_UNSIGNED_INT, NULL, pass->count);
}

conus_status torus_pass_frame(struct torus_pass *pass, const uint32_t size[2])
{
    struct gl_current previous;
    conus_status status = gl_context_use(pass->context, &previous);
    if (status) {
        return status;
    }
    status = frame_resize(&pass->frame, size);
    if (!status) {
        draw_frame(pass);
        glFlush();
    }
    gl_current_restore(&previous);
    return status;
}

conus_status torus_pass_wait(struct torus_pass *pass)
{
    struct gl_current previous;
    conus_status status = gl_context_use(pass->context, &previous);
    if (!status) {
        glFinish();
        gl_current_restore(&previous);
    }
    return status;
}

conus_status torus_pass_coverage(double *out, struct torus_pass *pass)
{
    struct gl_current previous;
    conus_status status = gl_context_use(pass->context, &previous);
    if (!status) {
        status = frame_coverage(out, &pass->frame);
        gl_current_restore(&previous);
    }
    return status;
}

conus_status torus_round_init(struct torus_round *out, size_t count, bool placed)
{
    const struct engine_options options = {0};
    *out = (struct torus_round){0};
    conus_status status = torus_scene_init(&out->scene, count);
    status = status ? status : create_pass(&out->pass, &out->scene);
    status = status ? status : create_pass_engine(&out->engines[TORUS_ALL_DRAWN], out->pass);
    if (!status && placed) {
        status = torus_scene_rays(&out->rays, &out->scene);
        return status ? status : mesh_engine_create(&out->engines[TORUS_RAYS], out->rays, 0);
    }
    status = status ? status : torus_scene_atlas(&out->atlas, &out->scene);
    status = status ? status : engine_gl_create(&out->engines[TORUS_GL], out->atlas, &options);
    return status ? status : engine_rays_create(&out->engines[TORUS_RAYS], out->atlas, &options);
}

void torus_round_finish(struct torus_round *round)
{
    for (int way = 0; way < TORUS_WAYS; way++) {
        engine_destroy(round->engines[way]);
    }
    destroy_pass(round->pass);
    mesh_rays_destroy(round->rays);
    conus_atlas_destroy(round->atlas);
    torus_scene_finish(&round->scene);
}

void torus_round_name(char *out, size_t size, const struct torus_round *round, enum torus_way way)
{
    static const char *const names[TORUS_WAYS] = {"all drawn", "gl engine", "rays engine"};
    const char *name = way == TORUS_RAYS && round->rays ? "placed, rays by rule" : names[way];
    snprintf(out, size, "%zu tori, %s", round->scene.count, name);
}
