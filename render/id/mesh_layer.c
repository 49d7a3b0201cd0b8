/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads the meshes of an atlas and draws them for a camera, and streamlines with them. */
#include "render/id/mesh_layer.h"

#include "base/geometry/math3.h"
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

struct mesh_program {
    GLuint program;
    GLint eye, camera_from_world, shift, mapped, ramp;
};

struct mesh_layer {
    struct mesh_program solid, peel;
    GLint taken; /* of peel */
    GLuint vertices, vertex_buffer, index_buffer, map_buffer;
    uint32_t mapped; /* Number of the surface that has a map; 0 = none. */
    size_t part_count;
    struct part *parts;   /* [part_count] */
    GLsizei *counts;      /* [part_count] The drawn parts, without gaps: Mesa 22.3 draws nothing behind one. */
    const void **offsets; /* [part_count] Likewise. */
    GLsizei drawn_count;
    bool *shown; /* [part_count] Parts that are not hidden. */
    struct target target;
    struct target peeled; /* one layer of translucent meshes */
    struct mesh_layer_peels peels;
    size_t peel_capacity;
    struct tube_layer *tubes; /* NULL if there are none. */
};

/* Each triangle adds its normal, weighted by its area, to its corners. */
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

/* The surfaces around the areas come after the objects. */
static size_t count_parts(const conus_atlas *atlas)
{
    return atlas->object_count + atlas->context_surface_count;
}

static const struct mesh *part_mesh(const conus_atlas *atlas, size_t part)
{
    return part < atlas->object_count ? atlas_stored_mesh(atlas, (uint32_t)part + 1)
                                      : &atlas->context_surfaces[part - atlas->object_count].mesh;
}

struct sizes {
    size_t vertices, indices;
};

static conus_status check_sizes(struct sizes *out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    for (size_t part = 0; part < count_parts(atlas); part++) {
        const struct mesh *mesh = part_mesh(atlas, part);
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

/* Lays the numbers of a surface's map beside all vertices: their part of the range, and 1, or twice 0 where there is no
 * number. Both are interpolated; one by the other is then the number between the corners that have one. */
static conus_status upload_map(struct mesh_layer *layer, const struct context_surface *surface, size_t first,
                               size_t count)
{
    float(*values)[2] = memory_zeroed(count, sizeof *values);
    if (!values) {
        return CONUS_ERROR_MEMORY;
    }
    double span = surface->high - surface->low;
    for (size_t v = 0; v < surface->mesh.vertex_count; v++) {
        double value = (double)surface->values[v];
        if (!isnan(value)) {
            values[first + v][0] = span > 0 ? (float)((value - surface->low) / span) : 0.5F;
            values[first + v][1] = 1;
        }
    }
    glCreateBuffers(1, &layer->map_buffer);
    glNamedBufferStorage(layer->map_buffer, (GLsizeiptr)(count * sizeof *values), values, 0);
    glVertexArrayVertexBuffer(layer->vertices, 1, layer->map_buffer, 0, sizeof *values);
    glEnableVertexArrayAttrib(layer->vertices, 3);
    glVertexArrayAttribBinding(layer->vertices, 3, 1);
    glVertexArrayAttribFormat(layer->vertices, 3, 2, GL_FLOAT, GL_FALSE, 0);
    memory_free(values);
    return CONUS_OK;
}

static conus_status upload_meshes(struct mesh_layer *layer, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct sizes sizes = {0};
    conus_status status = check_sizes(&sizes, atlas, memory_left);
    if (status || !sizes.indices) {
        return status; /* without triangles: streamlines alone */
    }
    struct vertex *vertices = memory_raw(sizes.vertices, sizeof *vertices);
    uint32_t *indices = memory_raw(sizes.indices, sizeof *indices);
    if (!vertices || !indices) {
        memory_free(vertices);
        memory_free(indices);
        return CONUS_ERROR_MEMORY;
    }
    struct sizes next = {0};
    const struct context_surface *mapped = atlas_mapped_surface(atlas);
    size_t first_mapped = 0;
    for (size_t part = 0; part < count_parts(atlas); part++) {
        const struct mesh *mesh = part_mesh(atlas, part);
        if (mapped && mesh == &mapped->mesh) {
            first_mapped = next.vertices;
            layer->mapped = (uint32_t)part + 1;
        }
        if (mesh) {
            fill_mesh(vertices + next.vertices, indices + next.indices, (uint32_t)next.vertices, mesh,
                      (uint32_t)part + 1);
            layer->parts[part].count = (GLsizei)(3 * mesh->triangle_count);
            layer->parts[part].offset = (const void *)(next.indices * sizeof *indices); /* as GL has it */
            next.vertices += mesh->vertex_count;
            next.indices += 3 * mesh->triangle_count;
        }
    }
    static const GLuint offsets[] = {offsetof(struct vertex, position), offsetof(struct vertex, normal)};
    glCreateBuffers(1, &layer->vertex_buffer);
    glNamedBufferStorage(layer->vertex_buffer, (GLsizeiptr)(next.vertices * sizeof *vertices), vertices, 0);
    glCreateBuffers(1, &layer->index_buffer);
    glNamedBufferStorage(layer->index_buffer, (GLsizeiptr)(next.indices * sizeof *indices), indices, 0);
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
    memory_free(vertices);
    memory_free(indices);
    status = mapped ? upload_map(layer, mapped, first_mapped, next.vertices) : CONUS_OK;
    return status ? status : gl_check("meshes");
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

/* Shows the meshes that are not hidden. */
static void show_parts(struct mesh_layer *layer, const conus_atlas *atlas)
{
    for (size_t i = 0; i < layer->part_count; i++) {
        bool is_around = i >= atlas->object_count;
        layer->shown[i] = layer->parts[i].count && (is_around || atlas_object_mesh(atlas, (uint32_t)i + 1));
    }
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
    if (!status) {
        const size_t count = count_parts(atlas);
        layer->part_count = count;
        layer->counts = memory_zeroed(count, sizeof *layer->counts);
        layer->parts = memory_zeroed(count, sizeof *layer->parts);
        layer->offsets = memory_zeroed(count, sizeof(void *));
        layer->shown = memory_zeroed(count, sizeof *layer->shown);
        status = layer->counts && layer->parts && layer->offsets && layer->shown ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : upload_meshes(layer, atlas, memory_left);
    status = status || !atlas->tractogram_count ? status : tube_layer_create(&layer->tubes, atlas, memory_left);
    if (status) {
        mesh_layer_destroy(layer);
        return status;
    }
    show_parts(layer, atlas);
    *out = layer;
    return CONUS_OK;
}

conus_status mesh_layer_update(struct mesh_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale)
{
    show_parts(layer, atlas);
    return layer->tubes ? tube_layer_update(layer->tubes, atlas, colouring, is_pale) : CONUS_OK;
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
        memory_free(layer->shown);
        memory_free(layer->counts);
        memory_free(layer->parts);
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

/* Rows of the shaders' camera_from_world: right and up in halves of the picture from its middle, and forward. */
static void find_rows(double rows[9], const struct mesh_layer_view *view)
{
    const double *m = view->camera->world_from_camera;
    for (int a = 0; a < 3; a++) {
        rows[a] = (m[a] + view->camera->middle[0] * m[8 + a]) / view->camera->slope[0];
        rows[3 + a] = (m[4 + a] + view->camera->middle[1] * m[8 + a]) / view->camera->slope[1];
        rows[6 + a] = -m[8 + a];
    }
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
    find_rows(rows, view);
    find_shift(shift, view);
    glUseProgram(program->program);
    glUniform3dv(program->eye, 1, view->camera->world_from_camera + 12);
    glUniformMatrix3dv(program->camera_from_world, 1, GL_TRUE, rows);
    glUniform2fv(program->shift, 1, shift);
    glUniform1ui(program->mapped, mapped);
    float ramp[TUBE_RAMP_STEPS + 1][3];
    for (int step = 0; step <= TUBE_RAMP_STEPS; step++) {
        uint8_t rgb[3];
        tube_scalar_colour(rgb, (double)step / TUBE_RAMP_STEPS);
        for (int c = 0; c < 3; c++) {
            ramp[step][c] = (float)rgb[c] / 255;
        }
    }
    glUniform3fv(program->ramp, TUBE_RAMP_STEPS + 1, ramp[0]);
}

/* Lists the parts that are opaque, or those that are translucent. */
static void list_parts(struct mesh_layer *layer, const float *opacity, bool translucent)
{
    layer->drawn_count = 0;
    for (size_t i = 0; i < layer->part_count; i++) {
        float part = opacity ? opacity[i + 1] : 1;
        if (layer->shown[i] && part > 0 && (part < 1) == translucent) {
            layer->counts[layer->drawn_count] = layer->parts[i].count;
            layer->offsets[layer->drawn_count++] = layer->parts[i].offset;
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
        find_rows(rows, tubes);
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
        use_program(&layer->peel, view, layer->mapped);
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
    use_program(&layer->solid, view, layer->mapped);
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
