/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads the meshes of an atlas and draws them for a camera, and streamlines with them. */
#include "render/passes/id_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/gl.h"

#include <stddef.h>

struct mesh_program {
    GLuint program;
    GLint eye, camera_from_world, shift, mapped, ramp;
};

struct mesh_layer {
    struct mesh_list parts; /* whose lists are in the buffers */
    struct mesh_program solid, peel;
    GLint taken; /* of peel */
    GLuint vertices, vertex_buffer, index_buffer, map_buffer;
    GLsizei *counts;      /* [part_count] The drawn parts, without gaps: Mesa 22.3 draws nothing behind one. */
    const void **offsets; /* [part_count] Likewise. */
    GLsizei drawn_count;
    struct target target;
    struct target peeled; /* one layer of translucent meshes */
    struct mesh_layer_peels peels;
    size_t peel_capacity;
    struct tube_layer *tubes; /* NULL if there are none. */
};

static void upload_map(struct mesh_layer *layer)
{
    const struct mesh_list *parts = &layer->parts;
    glCreateBuffers(1, &layer->map_buffer);
    glNamedBufferStorage(layer->map_buffer, (GLsizeiptr)(parts->vertex_count * sizeof *parts->values), parts->values,
                         0);
    glVertexArrayVertexBuffer(layer->vertices, 1, layer->map_buffer, 0, sizeof *parts->values);
    glEnableVertexArrayAttrib(layer->vertices, 3);
    glVertexArrayAttribBinding(layer->vertices, 3, 1);
    glVertexArrayAttribFormat(layer->vertices, 3, 2, GL_FLOAT, GL_FALSE, 0);
}

static conus_status upload_meshes(struct mesh_layer *layer)
{
    static const GLuint offsets[] = {offsetof(struct mesh_vertex, position), offsetof(struct mesh_vertex, normal)};
    struct mesh_list *parts = &layer->parts;
    if (!parts->index_count) {
        return CONUS_OK;
    }
    glCreateBuffers(1, &layer->vertex_buffer);
    glNamedBufferStorage(layer->vertex_buffer, (GLsizeiptr)(parts->vertex_count * sizeof *parts->vertices),
                         parts->vertices, 0);
    glCreateBuffers(1, &layer->index_buffer);
    glNamedBufferStorage(layer->index_buffer, (GLsizeiptr)(parts->index_count * sizeof *parts->indices), parts->indices,
                         0);
    glCreateVertexArrays(1, &layer->vertices);
    glVertexArrayVertexBuffer(layer->vertices, 0, layer->vertex_buffer, 0, sizeof *parts->vertices);
    glVertexArrayElementBuffer(layer->vertices, layer->index_buffer);
    for (GLuint k = 0; k < 3; k++) {
        glEnableVertexArrayAttrib(layer->vertices, k);
        glVertexArrayAttribBinding(layer->vertices, k, 0);
    }
    for (GLuint k = 0; k < 2; k++) {
        glVertexArrayAttribFormat(layer->vertices, k, 3, GL_FLOAT, GL_FALSE, offsets[k]);
    }
    glVertexArrayAttribIFormat(layer->vertices, 2, 1, GL_UNSIGNED_INT, offsetof(struct mesh_vertex, object));
    if (parts->values) {
        upload_map(layer);
    }
    mesh_list_drop(parts);
    return gl_check("meshes");
}

static conus_status make_program(struct mesh_program *out, bool peels)
{
    const struct program_define defines[] = {{"PEEL", peels}, {"STEPS", TUBE_RAMP_STEPS}};
    const struct program_source source = {.vertex = {.file = "mesh.vert.glsl", .text = shader_mesh_vert},
                                          .fragment = {.file = "mesh.frag.glsl", .text = shader_mesh_frag},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof *defines};
    conus_status status = program_create(&out->program, &source);
    if (!status) {
        out->eye = program_uniform(out->program, "eye");
        out->camera_from_world = program_uniform(out->program, "camera_from_world");
        out->shift = program_uniform(out->program, "shift");
        out->mapped = program_uniform(out->program, "mapped");
        out->ramp = program_uniform(out->program, "ramp");
    }
    return status;
}

conus_status mesh_layer_create(struct mesh_layer **out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct mesh_layer *layer = memory_zeroed(1, sizeof *layer);
    if (!layer) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = make_program(&layer->solid, false);
    status = status ? status : make_program(&layer->peel, true);
    if (!status) {
        layer->taken = program_uniform(layer->peel.program, "taken");
    }
    status = status ? status : mesh_list_init(&layer->parts, atlas, memory_left);
    if (!status) {
        layer->counts = memory_zeroed(layer->parts.part_count, sizeof *layer->counts);
        layer->offsets = memory_zeroed(layer->parts.part_count, sizeof(void *));
        status = layer->counts && layer->offsets ? upload_meshes(layer) : CONUS_ERROR_MEMORY;
    }
    status = status || !atlas->tractogram_count ? status : tube_layer_create(&layer->tubes, atlas, memory_left);
    if (status) {
        mesh_layer_destroy(layer);
        return status;
    }
    *out = layer;
    return CONUS_OK;
}

conus_status mesh_layer_update(struct mesh_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale)
{
    mesh_list_show(&layer->parts, atlas);
    return layer->tubes ? tube_layer_update(layer->tubes, colouring, is_pale) : CONUS_OK;
}

void mesh_layer_destroy(struct mesh_layer *layer)
{
    if (layer) {
        const GLuint buffers[] = {layer->vertex_buffer, layer->index_buffer, layer->map_buffer};
        const GLuint textures[] = {layer->peels.surface, layer->peels.object};
        target_finish(&layer->target);
        target_finish(&layer->peeled);
        glDeleteTextures(2, textures);
        glDeleteBuffers(3, buffers);
        glDeleteVertexArrays(1, &layer->vertices);
        tube_layer_destroy(layer->tubes);
        glDeleteProgram(layer->solid.program);
        glDeleteProgram(layer->peel.program);
        mesh_list_finish(&layer->parts);
        memory_free(layer->counts);
        memory_free(layer->offsets);
        memory_free(layer);
    }
}

static conus_status resize_target(struct target *target, uint32_t width, uint32_t height)
{
    static const struct target_attachment attachments[] = {
        {"surface", TARGET_FLOAT4}, {"object", TARGET_UINT}, {"depth", TARGET_DEPTH}};
    if (target->width == width && target->height == height) {
        return CONUS_OK;
    }
    target_finish(target);
    return target_init(target, width, height, attachments, 3);
}

/* In halves of the picture. */
static void find_shift(float out[2], const struct mesh_layer_view *view)
{
    out[0] = (float)(2 * view->shift[0] / view->width);
    out[1] = (float)(2 * view->shift[1] / view->height);
}

static void use_program(const struct mesh_program *program, const struct mesh_layer_view *view, uint32_t mapped)
{
    double rows[9];
    float shift[2];
    mesh_camera_rows(rows, view->camera);
    find_shift(shift, view);
    glUseProgram(program->program);
    glUniform3dv(program->eye, 1, view->camera->world_from_camera + 12);
    glUniformMatrix3dv(program->camera_from_world, 1, GL_TRUE, rows);
    glUniform2fv(program->shift, 1, shift);
    glUniform1ui(program->mapped, mapped);
    float ramp[TUBE_RAMP_STEPS + 1][3];
    tube_ramp(ramp);
    glUniform3fv(program->ramp, TUBE_RAMP_STEPS + 1, ramp[0]);
}

/* Lists the parts that are opaque, or those that are translucent. */
static void list_parts(struct mesh_layer *layer, const float *opacity, bool translucent)
{
    layer->drawn_count = 0;
    for (size_t i = 0; i < layer->parts.part_count; i++) {
        if (mesh_list_draws(&layer->parts, i, opacity, translucent)) {
            const struct mesh_entry *part = &layer->parts.parts[i];
            layer->counts[layer->drawn_count] = (GLsizei)part->count;
            layer->offsets[layer->drawn_count++] = (const void *)(part->first * sizeof(uint32_t)); /* as GL has it */
        }
    }
}

/* Draws the listed parts with the layer's or the peeling program, and streamlines if there is a picture. */
static conus_status draw_parts(const struct mesh_layer *layer, const struct target *target,
                               const struct mesh_layer_view *tubes)
{
    conus_status status = CONUS_OK;
    static const GLfloat infinity = 0; /* depths are reversed, so that floats are as fine far away as nearby */
    target_clear(target);
    glClearBufferfv(GL_DEPTH, 0, &infinity);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(GL_GREATER);
    if (layer->drawn_count) {
        glBindVertexArray(layer->vertices);
        glMultiDrawElements(GL_TRIANGLES, layer->counts, GL_UNSIGNED_INT, layer->offsets, layer->drawn_count);
    }
    if (tubes && layer->tubes) {
        double rows[9];
        mesh_camera_rows(rows, tubes->camera);
        struct tube_layer_view tube_view = {.eye = tubes->camera->world_from_camera + 12,
                                            .camera_from_world = rows,
                                            .width = tubes->width,
                                            .height = tubes->height,
                                            .draft = tubes->draft,
                                            .listener = tubes->listener};
        find_shift(tube_view.shift, tubes);
        status = tube_layer_draw(layer->tubes, &tube_view);
    }
    glDepthFunc(GL_LESS);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    return status;
}

static GLuint array_texture(GLenum format, const struct target *like, size_t count)
{
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
    glTextureStorage3D(texture, 1, format, (GLsizei)like->width, (GLsizei)like->height, (GLsizei)count);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

/* Makes textures for `count` layers. */
static conus_status resize_peels(struct mesh_layer *layer, const struct mesh_layer_view *view, size_t count)
{
    const struct target *peeled = &layer->peeled;
    bool same = peeled->width == view->width && peeled->height == view->height && layer->peel_capacity >= count;
    conus_status status = resize_target(&layer->peeled, view->width, view->height);
    if (!status && !same) {
        const GLuint textures[] = {layer->peels.surface, layer->peels.object};
        glDeleteTextures(2, textures);
        layer->peels.surface = array_texture(GL_RGBA32F, peeled, count);
        layer->peels.object = array_texture(GL_R32UI, peeled, count);
        layer->peel_capacity = count;
        status = gl_check("layers of meshes");
    }
    return status;
}

static conus_status draw_peels(struct mesh_layer *layer, const struct mesh_layer_view *view)
{
    size_t most = layer->drawn_count < MESH_LAYER_PEELS ? (size_t)layer->drawn_count : MESH_LAYER_PEELS;
    conus_status status = resize_peels(layer, view, most);
    GLuint any = GL_TRUE;
    GLuint query = 0;
    glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &query);
    for (size_t n = 0; n < most && any && !status; n++) {
        glBindTextureUnit(0, layer->peels.object);
        use_program(&layer->peel, view, layer->parts.mapped);
        glUniform1i(layer->taken, (GLint)n);
        glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
        status = draw_parts(layer, &layer->peeled, NULL);
        glEndQuery(GL_ANY_SAMPLES_PASSED);
        glGetQueryObjectuiv(query, GL_QUERY_RESULT, &any);
        if (any) {
            const struct target *from = &layer->peeled;
            const GLuint drawn[] = {target_texture(from, "surface"), target_texture(from, "object")};
            const GLuint kept[] = {layer->peels.surface, layer->peels.object};
            for (int i = 0; i < 2; i++) {
                glCopyImageSubData(drawn[i], GL_TEXTURE_2D, 0, 0, 0, 0, kept[i], GL_TEXTURE_2D_ARRAY, 0, 0, 0, (GLint)n,
                                   (GLsizei)from->width, (GLsizei)from->height, 1);
            }
            layer->peels.count = n + 1;
        }
        status = status ? status : gl_check("layers of meshes");
    }
    glDeleteQueries(1, &query);
    return status;
}

conus_status mesh_layer_draw(struct mesh_layer *layer, const struct mesh_layer_view *view)
{
    conus_status status = resize_target(&layer->target, view->width, view->height);
    if (status) {
        return status;
    }
    list_parts(layer, view->opacity, false);
    use_program(&layer->solid, view, layer->parts.mapped);
    status = draw_parts(layer, &layer->target, view);
    status = status ? status : gl_check("meshes");
    layer->peels.count = 0;
    list_parts(layer, view->opacity, true);
    return status || !layer->drawn_count ? status : draw_peels(layer, view);
}

struct mesh_layer_peels mesh_layer_peels(const struct mesh_layer *layer)
{
    return layer->peels;
}

GLuint mesh_layer_surface(const struct mesh_layer *layer)
{
    return target_texture(&layer->target, "surface");
}

GLuint mesh_layer_object(const struct mesh_layer *layer)
{
    return target_texture(&layer->target, "object");
}
