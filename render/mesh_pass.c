/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/mesh_pass.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/context.h"
#include "render/program.h"
#include "render/shader_list.h"
#include "render/shaders.h"
#include "render/target.h"

#include <string.h>

enum { POSITION_UNIT, CORNER_UNIT };
enum { PIXEL_BUFFER, HIT_BUFFER };
enum { FIRST_ROOM = 6, ROOM_STEP = 8 };
enum { BATCH = 4096 }; /* triangles; Mesa 22.3's llvmpipe takes thrice the time for each in batches of 16384 */

enum { FIRST_HITS = 1024, PIERCE_BATCH = 65536 };

/* Uniforms that a program has not are -1, which GL ignores. */
struct mesh_program {
    GLuint program;
    GLint apex, device_from_world, parallel, resolution;
    GLint direction_from_place, origin_from_place; /* of `first` only */
    GLint pixels;                                  /* of `all` only   */
};

struct mesh_pass {
    const struct mesh *const *meshes; /* a copy of the caller's array, by object */
    struct clusters clusters;
    struct mesh_cull *cull;
    struct mesh_program first, all; /* all: made when it is needed for the first time */
    GLuint vertices, position_buffer, corner_buffer, positions, corners;
    struct target target; /* without pixels: what is drawn goes to the buffer */
    GLuint pixel_buffer;
    uint32_t *pixels; /* [n n][2 + room]: the shader's nearest, count and triangles */
    uint32_t room;    /* triangles that a pixel can note in one batch */
    GLsizei *draw_counts;
    const void **draw_offsets;
    struct shader_list hits; /* of pixel and triangle */
};

/* ---- Creation ------------------------------------------------------------------------------------------------- */

static conus_status create_program(struct mesh_program *out, const struct program_shader *fragment, uint32_t room)
{
    const struct program_define defines[] = {{"ROOM", room},
                                             {"PIXEL_BUFFER", PIXEL_BUFFER},
                                             {"HIT_BUFFER", HIT_BUFFER},
                                             {"POSITION_UNIT", POSITION_UNIT},
                                             {"CORNER_UNIT", CORNER_UNIT}};
    const struct program_source source = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                                          .fragment = *fragment,
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    GLuint program = 0;
    conus_status status = program_create(&program, &source);
    if (status) {
        return status;
    }
    out->program = program;
    out->apex = program_uniform(program, "apex");
    out->device_from_world = program_uniform(program, "device_from_world");
    out->parallel = program_uniform(program, "parallel");
    out->resolution = program_uniform(program, "resolution");
    return CONUS_OK;
}

/* The program of the first triangle, with room for so many in every pixel. */
static conus_status create_first(struct mesh_pass *pass, uint32_t room)
{
    const struct program_shader fragment = {"mesh_id.frag.glsl", shader_mesh_id_frag};
    struct mesh_program first = {.pixels = -1};
    conus_status status = create_program(&first, &fragment, room);
    if (status) {
        return status;
    }
    first.direction_from_place = program_uniform(first.program, "direction_from_place");
    first.origin_from_place = program_uniform(first.program, "origin_from_place");
    glDeleteProgram(pass->first.program);
    pass->first = first;
    pass->room = room;
    return CONUS_OK;
}

/* That of all of them, and its list. */
static conus_status create_all(struct mesh_pass *pass)
{
    const struct program_shader fragment = {"mesh_hits.frag.glsl", shader_mesh_hits_frag};
    struct mesh_program all = {.direction_from_place = -1, .origin_from_place = -1};
    conus_status status = shader_list_init(&pass->hits, 2 * sizeof(uint32_t), FIRST_HITS);
    status = status ? status : create_program(&all, &fragment, 0);
    if (status) {
        shader_list_finish(&pass->hits);
        return status;
    }
    all.pixels = program_uniform(all.program, "pixels");
    pass->all = all;
    return CONUS_OK;
}

static conus_status check_size(const struct clusters *clusters, uint64_t *memory_left)
{
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    uint64_t size = (clusters->vertex_count + clusters->triangle_count) * UINT64_C(12);
    if (clusters->vertex_count > (size_t)limit) {
        return fail(CONUS_ERROR_GL, "meshes of %zu triangles: this driver allows some %d", clusters->triangle_count,
                    limit);
    }
    if (size > *memory_left) {
        return fail(CONUS_ERROR_MEMORY, "meshes of %zu triangles: %llu bytes, allowed are %llu more",
                    clusters->triangle_count, (unsigned long long)size, (unsigned long long)*memory_left);
    }
    *memory_left -= size;
    return CONUS_OK;
}

/* A buffer, and the texture through which shaders see it. */
static void upload(GLuint *buffer, GLuint *texture, GLenum format, const void *data, size_t size)
{
    glCreateBuffers(1, buffer);
    glNamedBufferStorage(*buffer, (GLsizeiptr)size, data, 0);
    glCreateTextures(GL_TEXTURE_BUFFER, 1, texture);
    glTextureBuffer(*texture, format, *buffer);
}

/* Uploads the triangles; afterwards only the driver has them. */
static conus_status upload_triangles(struct mesh_pass *pass, uint64_t *memory_left)
{
    struct clusters *clusters = &pass->clusters;
    conus_status status = check_size(clusters, memory_left);
    if (status) {
        return status;
    }
    upload(&pass->position_buffer, &pass->positions, GL_RGB32F, clusters->positions,
           clusters->vertex_count * 3 * sizeof *clusters->positions);
    upload(&pass->corner_buffer, &pass->corners, GL_RGB32UI, clusters->corners,
           clusters->triangle_count * 3 * sizeof *clusters->corners);
    glCreateBuffers(1, &pass->pixel_buffer);
    glCreateVertexArrays(1, &pass->vertices);
    glVertexArrayVertexBuffer(pass->vertices, 0, pass->position_buffer, 0, 3 * sizeof *clusters->positions);
    glVertexArrayElementBuffer(pass->vertices, pass->corner_buffer);
    glVertexArrayAttribFormat(pass->vertices, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(pass->vertices, 0, 0);
    glEnableVertexArrayAttrib(pass->vertices, 0);
    clusters_drop_triangles(clusters);
    return gl_check("meshes");
}

static conus_status reserve(struct mesh_pass *pass, const struct mesh *const *meshes, size_t count)
{
    const struct mesh **copy = memory_raw(count, sizeof(void *));
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(copy, meshes, count * sizeof(void *));
    pass->meshes = copy;
    conus_status status = clusters_init(&pass->clusters, meshes, count);
    status = status ? status : mesh_cull_create(&pass->cull, &pass->clusters);
    if (!status) {
        size_t clusters = pass->clusters.first_cluster[pass->clusters.mesh_count];
        pass->draw_counts = memory_raw(clusters, sizeof *pass->draw_counts);
        pass->draw_offsets = memory_raw(clusters, sizeof *pass->draw_offsets);
        status = pass->draw_counts && pass->draw_offsets ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    return status;
}

conus_status mesh_pass_create(struct mesh_pass **out, const struct mesh *const *meshes, size_t count,
                              uint64_t *memory_left)
{
    struct mesh_pass *pass = memory_zeroed(1, sizeof *pass);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = reserve(pass, meshes, count);
    status = status ? status : create_first(pass, FIRST_ROOM);
    status = status ? status : upload_triangles(pass, memory_left);
    if (status) {
        mesh_pass_destroy(pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

void mesh_pass_destroy(struct mesh_pass *pass)
{
    if (!pass) {
        return;
    }
    const GLuint buffers[] = {pass->position_buffer, pass->corner_buffer, pass->pixel_buffer};
    const GLuint textures[] = {pass->positions, pass->corners};
    glDeleteTextures(2, textures);
    glDeleteBuffers(3, buffers);
    glDeleteVertexArrays(1, &pass->vertices);
    glDeleteProgram(pass->first.program);
    glDeleteProgram(pass->all.program);
    target_finish(&pass->target);
    shader_list_finish(&pass->hits);
    mesh_cull_destroy(pass->cull);
    clusters_finish(&pass->clusters);
    memory_free((void *)pass->meshes);
    memory_free(pass->pixels);
    memory_free(pass->draw_counts);
    memory_free(pass->draw_offsets);
    memory_free(pass);
}

/* ---- Pixels --------------------------------------------------------------------------------------------------- */

static size_t pixel_count(const struct mesh_pass *pass)
{
    return (size_t)pass->target.width * pass->target.height;
}

static uint32_t *pixel_at(const struct mesh_pass *pass, size_t pixel)
{
    return pass->pixels + pixel * (2 + (size_t)pass->room);
}

static conus_status make_pixels(struct mesh_pass *pass)
{
    size_t size = pixel_count(pass) * (2 + (size_t)pass->room) * sizeof *pass->pixels;
    memory_free(pass->pixels);
    pass->pixels = memory_raw(1, size);
    if (!pass->pixels) {
        return CONUS_ERROR_MEMORY;
    }
    glNamedBufferData(pass->pixel_buffer, (GLsizeiptr)size, NULL, GL_STREAM_READ);
    return gl_check("pixels");
}

static conus_status resize(struct mesh_pass *pass, uint32_t resolution)
{
    if (pass->target.width == resolution && pass->pixels) {
        return CONUS_OK;
    }
    target_finish(&pass->target);
    conus_status status = target_init(&pass->target, resolution, resolution, NULL, 0);
    return status ? status : make_pixels(pass);
}

/* Room for @p count triangles in every pixel. */
static conus_status make_room(struct mesh_pass *pass, uint32_t count)
{
    uint32_t room = (count + 2 + ROOM_STEP - 1) / ROOM_STEP * ROOM_STEP - 2;
    conus_status status = create_first(pass, room);
    return status ? status : make_pixels(pass);
}

/* Nothing noted yet; what is known to be farther than `distances` need not be. */
static void upload_pixels(const struct mesh_pass *pass, const double *distances)
{
    for (size_t i = 0; i < pixel_count(pass); i++) {
        float nearest = (float)distances[i];
        memcpy(pixel_at(pass, i), &nearest, sizeof nearest);
        pixel_at(pass, i)[1] = 0;
    }
    GLsizeiptr size = (GLsizeiptr)(pixel_count(pass) * (2 + (size_t)pass->room) * sizeof *pass->pixels);
    glNamedBufferSubData(pass->pixel_buffer, 0, size, pass->pixels);
}

/* Waits for the drawing. */
static conus_status read_pixels(const struct mesh_pass *pass)
{
    GLsizeiptr size = (GLsizeiptr)(pixel_count(pass) * (2 + (size_t)pass->room) * sizeof *pass->pixels);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glFinish();
    glGetNamedBufferSubData(pass->pixel_buffer, 0, size, pass->pixels);
    return gl_check("mesh ID pass");
}

/* Eq. 9: nearest first; of equally near ones the lower object, then the lower triangle. */
static void weigh(const struct mesh_pass *pass, const struct mesh_pixels *pixels, size_t pixel, uint32_t drawn)
{
    uint32_t object = clusters_find(&pass->clusters, drawn)->object;
    uint64_t triangle = pass->clusters.triangle[drawn];
    const struct mesh *mesh = pass->meshes[object - 1];
    double t = mesh_distance(mesh, (size_t)triangle, pixels->origins[pixel], pixels->directions[pixel]);
    double known = pixels->distances[pixel];
    uint32_t holder = pixels->objects[pixel];
    bool wins_tie = object < holder || (object == holder && triangle < pixels->triangles[pixel]);
    if (t >= 0 && (t < known || (t <= known && wins_tie))) {
        pixels->objects[pixel] = object;
        pixels->distances[pixel] = t;
        pixels->triangles[pixel] = triangle;
    }
}

/* Weighs what the driver noted and returns the most that one pixel had to note. */
static uint32_t settle(const struct mesh_pass *pass, const struct mesh_pixels *pixels)
{
    uint32_t most = 0;
    for (size_t i = 0; i < pixel_count(pass); i++) {
        const uint32_t *pixel = pixel_at(pass, i);
        uint32_t count = pixel[1];
        most = count > most ? count : most;
        for (uint32_t k = 0; k < count && k < pass->room; k++) {
            weigh(pass, pixels, i, pixel[2 + k]);
        }
    }
    return most;
}

/* ---- A look --------------------------------------------------------------------------------------------------- */

static void use_program(const struct mesh_program *program, const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    bool parallel = view->radius > 0;
    double width = parallel ? view->radius : view->slope; /* half the buffer's edge, at depth 1 */
    double narrow[9], wide[9], sideways[6];
    for (int a = 0; a < 3; a++) {
        narrow[a] = m[a] / width;
        narrow[3 + a] = m[4 + a] / width;
        wide[a] = m[a] * view->slope;
        wide[3 + a] = m[4 + a] * view->slope;
        narrow[6 + a] = wide[6 + a] = -m[8 + a];
        sideways[a] = m[a] * view->radius;
        sideways[3 + a] = m[4 + a] * view->radius;
    }
    glUseProgram(program->program);
    glUniform3dv(program->apex, 1, m + 12);
    glUniformMatrix3dv(program->device_from_world, 1, GL_TRUE, narrow);
    glUniform1i(program->parallel, parallel);
    glUniformMatrix3dv(program->direction_from_place, 1, GL_FALSE, wide);
    glUniformMatrix2x3dv(program->origin_from_place, 1, GL_FALSE, sideways);
    glUniform1i(program->resolution, (GLint)view->resolution);
}

/* Draws with the program in use. */
static void draw(const struct mesh_pass *pass, const uint32_t *batch, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct cluster *cluster = &pass->clusters.cluster[batch[i]];
        pass->draw_counts[i] = (GLsizei)(3 * cluster->count);
        pass->draw_offsets[i] = (const void *)((uintptr_t)cluster->first * 3 * sizeof(uint32_t));
    }
    target_bind(&pass->target);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glBindTextureUnit(POSITION_UNIT, pass->positions);
    glBindTextureUnit(CORNER_UNIT, pass->corners);
    glBindVertexArray(pass->vertices);
    glMultiDrawElements(GL_TRIANGLES, pass->draw_counts, GL_UNSIGNED_INT, pass->draw_offsets, (GLsizei)count);
}

/* Draws a batch, again where a pixel had to note more triangles than it has room for: what is known by then leaves most
 * of them out, and if that is not enough there is more room. */
static conus_status look_at_batch(struct mesh_pass *pass, const struct mesh_view *view,
                                  const struct mesh_pixels *pixels, const uint32_t *batch, size_t count)
{
    conus_status status = CONUS_OK;
    uint32_t most = UINT32_MAX;
    for (int attempt = 0; most > pass->room && !status; attempt++) {
        status = attempt > 1 ? make_room(pass, most) : CONUS_OK;
        if (!status) {
            use_program(&pass->first, view);
            upload_pixels(pass, pixels->distances);
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, PIXEL_BUFFER, pass->pixel_buffer);
            draw(pass, batch, count);
            status = read_pixels(pass);
        }
        if (!status) {
            most = settle(pass, pixels);
        }
    }
    return status;
}

conus_status mesh_pass_look(struct mesh_pass *pass, const struct mesh_view *view, const struct mesh_pixels *pixels)
{
    conus_status status = resize(pass, view->resolution);
    mesh_cull_begin(pass->cull, view);
    const uint32_t *batch;
    size_t count = 1;
    while (count && !status) {
        mesh_cull_hide(pass->cull, pixels->distances);
        count = mesh_cull_batch(&batch, pass->cull, BATCH);
        status = count ? look_at_batch(pass, view, pixels, batch, count) : CONUS_OK;
    }
    return status;
}

/* ---- All layers ----------------------------------------------------------------------------------------------- */

struct piercing {
    struct mesh_pass *pass;
    const struct mesh_view *view;
    const uint32_t *batch; /* clusters */
    size_t count;
    mesh_pass_take take;
    void *user;
};

static conus_status draw_hits(void *user, uint32_t first, uint32_t end)
{
    const struct piercing *piercing = user;
    const struct mesh_program *all = &piercing->pass->all;
    use_program(all, piercing->view);
    glUniform2i(all->pixels, (GLint)first, (GLint)end);
    draw(piercing->pass, piercing->batch, piercing->count);
    return gl_check("mesh pass of all layers");
}

static conus_status take_hits(void *user, const void *records, uint32_t count)
{
    const struct piercing *piercing = user;
    const struct clusters *clusters = &piercing->pass->clusters;
    const uint32_t(*record)[2] = (const uint32_t(*)[2])records;
    conus_status status = CONUS_OK;
    for (uint32_t i = 0; i < count && !status; i++) {
        uint32_t drawn = record[i][1];
        const struct mesh_pass_hit hit = {record[i][0], clusters_find(clusters, drawn)->object,
                                          clusters->triangle[drawn]};
        status = piercing->take(piercing->user, &hit);
    }
    return status;
}

static uint32_t count_triangles(const struct piercing *piercing)
{
    uint32_t count = 0;
    for (size_t i = 0; i < piercing->count; i++) {
        count += piercing->pass->clusters.cluster[piercing->batch[i]].count;
    }
    return count;
}

conus_status mesh_pass_pierce(struct mesh_pass *pass, const struct mesh_view *view, mesh_pass_take take, void *user)
{
    struct piercing piercing = {.pass = pass, .view = view, .count = 1, .take = take, .user = user};
    uint32_t pixels = view->resolution * view->resolution;
    size_t countable = UINT32_MAX / pixels - CLUSTER_TRIANGLES; /* at once for all pixels, see shader_list.h */
    size_t triangles = countable < PIERCE_BATCH ? countable : PIERCE_BATCH;
    conus_status status = pass->all.program ? CONUS_OK : create_all(pass);
    status = status ? status : resize(pass, view->resolution);
    mesh_cull_begin(pass->cull, view);
    mesh_cull_hide(pass->cull, NULL);
    while (piercing.count && !status) {
        piercing.count = mesh_cull_batch(&piercing.batch, pass->cull, triangles);
        const struct shader_list_job job = {.binding = HIT_BUFFER,
                                            .draw = draw_hits,
                                            .take = take_hits,
                                            .user = &piercing,
                                            .pixels = pixels,
                                            .per_pixel = count_triangles(&piercing)};
        status = shader_list_collect(&pass->hits, &job);
    }
    return status;
}
