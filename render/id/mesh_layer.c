/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads the meshes of an atlas and draws them for a camera. */
#include "render/id/mesh_layer.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/shaders.h"

#include <stddef.h>

struct vertex {
    float position[3], normal[3];
    uint32_t object;
};

/* An object's triangles in the index buffer. */
struct part {
    GLsizei count; /* indices, 0 where it is no mesh */
    const void *offset;
};

struct mesh_layer {
    GLuint program;
    GLint eye, camera_from_world, shift;
    GLuint vertices, vertex_buffer, index_buffer;
    size_t object_count;
    struct part *parts;   /* [object_count] */
    GLsizei *counts;      /* [object_count] The parts that are drawn, one after the other: Mesa 22.3 draws nothing */
    const void **offsets; /* behind an empty one.                                                                   */
    GLsizei drawn_count;
    struct target target;
};

/* ---- Creation ------------------------------------------------------------------------------------------------- */

/* Each triangle adds its normal, as long as its area is large, to its corners. */
static void add_normals(struct vertex *vertices, const struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = &mesh->triangles[3 * i];
        double p[3][3], normal[3];
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++) {
                p[k][a] = (double)vertices[t[k]].position[a];
            }
        }
        vec3_sub(p[1], p[1], p[0]);
        vec3_sub(p[2], p[2], p[0]);
        vec3_cross(normal, p[1], p[2]);
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++) {
                vertices[t[k]].normal[a] += (float)normal[a];
            }
        }
    }
}

static void fill_mesh(struct vertex *vertices, uint32_t *indices, uint32_t first, const struct mesh *mesh,
                      uint32_t object)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        vertices[v] = (struct vertex){.object = object};
        for (size_t a = 0; a < 3; a++) {
            vertices[v].position[a] = mesh->positions[3 * v + a];
        }
    }
    add_normals(vertices, mesh);
    for (size_t k = 0; k < 3 * mesh->triangle_count; k++) {
        indices[k] = first + mesh->triangles[k];
    }
}

struct sizes {
    size_t vertices, indices;
};

static conus_status check_sizes(struct sizes *out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_stored_mesh(atlas, number);
        sizes.vertices += mesh ? mesh->vertex_count : 0;
        sizes.indices += mesh ? 3 * mesh->triangle_count : 0;
    }
    uint64_t size = sizes.vertices * (uint64_t)sizeof(struct vertex) + sizes.indices * UINT64_C(4);
    if (size > *memory_left || sizes.vertices > INT32_MAX || sizes.indices > INT32_MAX) {
        return fail(CONUS_ERROR_MEMORY, "meshes of %zu triangles: %llu bytes, allowed are %llu more", sizes.indices / 3,
                    (unsigned long long)size, (unsigned long long)*memory_left);
    }
    *memory_left -= size;
    *out = sizes;
    return CONUS_OK;
}

static void upload_buffers(struct mesh_layer *layer, const struct vertex *vertices, const uint32_t *indices,
                           const struct sizes *sizes)
{
    static const GLuint offsets[] = {offsetof(struct vertex, position), offsetof(struct vertex, normal)};
    glCreateBuffers(1, &layer->vertex_buffer);
    glNamedBufferStorage(layer->vertex_buffer, (GLsizeiptr)(sizes->vertices * sizeof *vertices), vertices, 0);
    glCreateBuffers(1, &layer->index_buffer);
    glNamedBufferStorage(layer->index_buffer, (GLsizeiptr)(sizes->indices * sizeof *indices), indices, 0);
    glCreateVertexArrays(1, &layer->vertices);
    glVertexArrayVertexBuffer(layer->vertices, 0, layer->vertex_buffer, 0, sizeof *vertices);
    glVertexArrayElementBuffer(layer->vertices, layer->index_buffer);
    for (GLuint k = 0; k < 3; k++) {
        glEnableVertexArrayAttrib(layer->vertices, k);
        glVertexArrayAttribBinding(layer->vertices, k, 0);
    }
    for (GLuint k = 0; k < 2; k++) {
        glVertexArrayAttribFormat(layer->vertices, k, 3, GL_FLOAT, GL_FALSE, offsets[k]);
    }
    glVertexArrayAttribIFormat(layer->vertices, 2, 1, GL_UNSIGNED_INT, offsetof(struct vertex, object));
}

static conus_status upload_meshes(struct mesh_layer *layer, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    conus_status status = check_sizes(&sizes, atlas, memory_left);
    struct vertex *vertices = status ? NULL : memory_raw(sizes.vertices, sizeof *vertices);
    uint32_t *indices = status ? NULL : memory_raw(sizes.indices, sizeof *indices);
    if (!status && vertices && indices) {
        struct sizes next = {0};
        for (uint32_t number = 1; number <= atlas->object_count; number++) {
            const struct mesh *mesh = atlas_stored_mesh(atlas, number);
            if (mesh) {
                fill_mesh(vertices + next.vertices, indices + next.indices, (uint32_t)next.vertices, mesh, number);
                layer->parts[number - 1].count = (GLsizei)(3 * mesh->triangle_count);
                layer->parts[number - 1].offset = (const void *)(next.indices * sizeof *indices); /* as GL has it */
                next.vertices += mesh->vertex_count;
                next.indices += 3 * mesh->triangle_count;
            }
        }
        upload_buffers(layer, vertices, indices, &next);
        status = gl_check("meshes");
    } else {
        status = status ? status : CONUS_ERROR_MEMORY;
    }
    memory_free(vertices);
    memory_free(indices);
    return status;
}

static conus_status make_program(struct mesh_layer *layer)
{
    static const struct program_source source = {.vertex = {"mesh.vert.glsl", shader_mesh_vert},
                                                 .fragment = {"mesh.frag.glsl", shader_mesh_frag}};
    conus_status status = program_create(&layer->program, &source);
    if (!status) {
        layer->eye = program_uniform(layer->program, "eye");
        layer->camera_from_world = program_uniform(layer->program, "camera_from_world");
        layer->shift = program_uniform(layer->program, "shift");
    }
    return status;
}

static conus_status make_parts(struct mesh_layer *layer, size_t object_count)
{
    layer->object_count = object_count;
    layer->counts = memory_zeroed(object_count, sizeof *layer->counts);
    layer->parts = memory_zeroed(object_count, sizeof *layer->parts);
    layer->offsets = memory_zeroed(object_count, sizeof(void *));
    return layer->counts && layer->parts && layer->offsets ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status mesh_layer_create(struct mesh_layer **out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct mesh_layer *layer = memory_zeroed(1, sizeof *layer);
    if (!layer) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = make_program(layer);
    status = status ? status : make_parts(layer, atlas->object_count);
    status = status ? status : upload_meshes(layer, atlas, memory_left);
    if (status) {
        mesh_layer_destroy(layer);
        return status;
    }
    mesh_layer_update(layer, atlas);
    *out = layer;
    return CONUS_OK;
}

void mesh_layer_update(struct mesh_layer *layer, const conus_atlas *atlas)
{
    layer->drawn_count = 0;
    for (size_t i = 0; i < layer->object_count; i++) {
        if (layer->parts[i].count && atlas_object_mesh(atlas, (uint32_t)i + 1)) {
            layer->counts[layer->drawn_count] = layer->parts[i].count;
            layer->offsets[layer->drawn_count++] = layer->parts[i].offset;
        }
    }
}

void mesh_layer_destroy(struct mesh_layer *layer)
{
    if (layer) {
        const GLuint buffers[] = {layer->vertex_buffer, layer->index_buffer};
        target_finish(&layer->target);
        glDeleteBuffers(2, buffers);
        glDeleteVertexArrays(1, &layer->vertices);
        glDeleteProgram(layer->program);
        memory_free(layer->counts);
        memory_free(layer->parts);
        memory_free(layer->offsets);
        memory_free(layer);
    }
}

/* ---- Drawing -------------------------------------------------------------------------------------------------- */

static conus_status resize(struct mesh_layer *layer, uint32_t width, uint32_t height)
{
    static const struct target_attachment attachments[] = {
        {"surface", TARGET_FLOAT4}, {"object", TARGET_UINT}, {"depth", TARGET_DEPTH}};
    if (layer->target.width == width && layer->target.height == height) {
        return CONUS_OK;
    }
    target_finish(&layer->target);
    return target_init(&layer->target, width, height, attachments, 3);
}

static void set_view(const struct mesh_layer *layer, const struct mesh_layer_view *view)
{
    const double *m = view->camera->world_from_camera;
    double rows[9];
    for (int a = 0; a < 3; a++) {
        rows[a] = (m[a] + view->camera->middle[0] * m[8 + a]) / view->camera->slope[0];
        rows[3 + a] = (m[4 + a] + view->camera->middle[1] * m[8 + a]) / view->camera->slope[1];
        rows[6 + a] = -m[8 + a];
    }
    glUseProgram(layer->program);
    glUniform3dv(layer->eye, 1, m + 12);
    glUniformMatrix3dv(layer->camera_from_world, 1, GL_TRUE, rows);
    glUniform2f(layer->shift, (float)(2 * view->shift[0] / view->width), (float)(2 * view->shift[1] / view->height));
}

conus_status mesh_layer_draw(struct mesh_layer *layer, const struct mesh_layer_view *view)
{
    static const GLfloat infinity = 0; /* depths are reversed, so that floats are as fine far away as nearby */
    conus_status status = resize(layer, view->width, view->height);
    if (status) {
        return status;
    }
    target_clear(&layer->target);
    glClearBufferfv(GL_DEPTH, 0, &infinity);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(GL_GREATER);
    set_view(layer, view);
    glBindVertexArray(layer->vertices);
    glMultiDrawElements(GL_TRIANGLES, layer->counts, GL_UNSIGNED_INT, layer->offsets, layer->drawn_count);
    glDepthFunc(GL_LESS);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    return gl_check("meshes");
}

GLuint mesh_layer_surface(const struct mesh_layer *layer)
{
    return target_texture(&layer->target, "surface");
}

GLuint mesh_layer_object(const struct mesh_layer *layer)
{
    return target_texture(&layer->target, "object");
}
