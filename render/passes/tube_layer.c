/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads the streamlines of an atlas and draws them for a camera. */
#include "render/passes/id_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/gl.h"
#include "render/passes/shapes.h"

/* Instances that are drawn before the listener may cancel. */
enum { PIECE = 50000 };

struct tube_layer {
    struct tubes tubes;
    GLuint program, vertices, points, paints;
    GLint eye, camera_from_world, world_from_camera, shift, size, radius;
};

static conus_status upload(struct tube_layer *layer)
{
    size_t count = layer->tubes.point_count;
    float(*points)[3] = memory_zeroed(count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    tubes_points(points, &layer->tubes);
    glCreateBuffers(1, &layer->points);
    glNamedBufferStorage(layer->points, (GLsizeiptr)((count + 1) * sizeof *points), points, 0);
    glCreateBuffers(1, &layer->paints);
    glNamedBufferData(layer->paints, (GLsizeiptr)((count + 1) * sizeof(uint32_t)), NULL, GL_DYNAMIC_DRAW);
    memory_free(points);
    glCreateVertexArrays(1, &layer->vertices);
    glVertexArrayVertexBuffer(layer->vertices, 0, layer->points, 0, 3 * sizeof(float));
    glVertexArrayVertexBuffer(layer->vertices, 1, layer->points, 3 * sizeof(float), 3 * sizeof(float));
    glVertexArrayVertexBuffer(layer->vertices, 2, layer->paints, 0, sizeof(uint32_t));
    for (GLuint k = 0; k < 3; k++) {
        glEnableVertexArrayAttrib(layer->vertices, k);
        glVertexArrayAttribBinding(layer->vertices, k, k);
        glVertexArrayBindingDivisor(layer->vertices, k, 1);
    }
    glVertexArrayAttribFormat(layer->vertices, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribFormat(layer->vertices, 1, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribIFormat(layer->vertices, 2, 1, GL_UNSIGNED_INT, 0);
    return gl_check("streamlines");
}

static conus_status make_program(struct tube_layer *layer)
{
    const struct program_source source = {.vertex = {.file = "tube.vert.glsl", .text = shader_tube_vert},
                                          .fragment = {.file = "tube.frag.glsl", .text = shader_tube_frag}};
    conus_status status = program_create(&layer->program, &source);
    if (!status) {
        layer->eye = program_uniform(layer->program, "eye");
        layer->camera_from_world = program_uniform(layer->program, "camera_from_world");
        layer->world_from_camera = program_uniform(layer->program, "world_from_camera");
        layer->shift = program_uniform(layer->program, "shift");
        layer->size = program_uniform(layer->program, "size");
        layer->radius = program_uniform(layer->program, "radius");
    }
    return status;
}

conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct tube_layer *layer = memory_zeroed(1, sizeof *layer);
    if (!layer) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = make_program(layer);
    status = status ? status : tubes_init(&layer->tubes, atlas, memory_left);
    status = status ? status : upload(layer);
    status = status ? status : tube_layer_update(layer, &(const struct tube_colouring){0}, NULL);
    if (status) {
        tube_layer_destroy(layer);
        return status;
    }
    *out = layer;
    return CONUS_OK;
}

void tube_layer_destroy(struct tube_layer *layer)
{
    if (layer) {
        const GLuint buffers[] = {layer->points, layer->paints};
        glDeleteBuffers(2, buffers);
        glDeleteVertexArrays(1, &layer->vertices);
        glDeleteProgram(layer->program);
        tubes_finish(&layer->tubes);
        memory_free(layer);
    }
}

conus_status tube_layer_update(struct tube_layer *layer, const struct tube_colouring *colouring,
                               const bool *const *is_pale)
{
    const size_t count = layer->tubes.point_count;
    uint32_t *paints = memory_zeroed(count + 1, sizeof *paints);
    conus_status status = paints ? tubes_paint(paints, &layer->tubes, colouring, is_pale) : CONUS_ERROR_MEMORY;
    if (!status) {
        glNamedBufferSubData(layer->paints, 0, (GLsizeiptr)(count * sizeof *paints), paints);
        status = gl_check("streamlines");
    }
    memory_free(paints);
    return status;
}

conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view)
{
    static const GLuint strip = 4;
    conus_status status = CONUS_OK;
    double columns[9];
    float inverse[9];
    mesh_camera_columns(columns, view->camera_from_world);
    for (int i = 0; i < 9; i++) {
        inverse[i] = (float)columns[i];
    }
    glUseProgram(layer->program);
    glUniform3dv(layer->eye, 1, view->eye);
    glUniformMatrix3dv(layer->camera_from_world, 1, GL_TRUE, view->camera_from_world);
    glUniformMatrix3fv(layer->world_from_camera, 1, GL_FALSE, inverse);
    glUniform2fv(layer->shift, 1, view->shift);
    glUniform2f(layer->size, (float)view->width, (float)view->height);
    glBindVertexArray(layer->vertices);
    for (size_t i = 0; i < layer->tubes.range_count && !status; i++) {
        const struct tube_range *range = &layer->tubes.ranges[i];
        glUniform1f(layer->radius, fmaxf(range->radius, (float)view->draft / 2));
        GLsizei count = (GLsizei)(view->draft > 0 ? range->draft : range->count);
        GLsizei most = view->listener.progress ? PIECE : count;
        for (GLsizei done = 0; done < count && !status; done += most) {
            GLsizei piece = count - done < most ? count - done : most;
            glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, strip, piece, (GLuint)range->first + (GLuint)done);
            status = gl_tell(&view->listener, (size_t)done + (size_t)piece, (size_t)count);
        }
    }
    return status;
}
