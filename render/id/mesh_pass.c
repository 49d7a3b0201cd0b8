/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws batches of clusters, reads the proposed triangles and decides which is nearest. */
#include "render/id/mesh_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/shader_list.h"
#include "render/gl/shaders.h"
#include "render/gl/target.h"

#include <string.h>

enum { POSITION_UNIT, CORNER_UNIT };
enum { PIXEL_BUFFER, HIT_BUFFER };
/* Locations of uniforms: of both programs, of `first`, and of `all`. */
enum { APEX, DEVICE_FROM_WORLD, PARALLEL, RESOLUTION, OWN };
enum { DIRECTION_FROM_PLACE = OWN, ORIGIN_FROM_PLACE, FIRST_PIXEL };
enum { PIXELS = OWN };
enum { FIRST_CAPACITY = 6, CAPACITY_STEP = 8 };
/* Triangles of a batch. On a GPU each batch is waited for. On the CPU waiting costs nothing, so batches are smaller:
 * fewer triangles are drawn that earlier ones occlude. */
enum { BATCH = 4096, SOFTWARE_BATCH = 1024, PIERCE_BATCH = 65536, FIRST_HITS = 1024 };

/* llvmpipe keeps triangles until it rasterises, in memory that it returns to the system afterwards. By page faults
 * thousands of them cost two to three times as much each as hundreds. So it is made to begin after SOFTWARE_PORTION. */
enum { SOFTWARE_PORTION = 1024 };

/* Queries are under way side by side while their culling takes at most SLOT_MEMORY bytes. They are drawn and read at
 * once while their pixels take at most PIXEL_MEMORY bytes. */
enum { SLOT_LIMIT = 256, SLOT_MEMORY = 1 << 28, PIXEL_MEMORY = 1 << 24 };

/* A query under way. */
struct slot {
    const struct mesh_query *query;
    struct mesh_cull *cull;
    const uint32_t *batch; /* clusters, borrowed from cull; count 0 = all of the last batch is settled */
    size_t count;
    uint32_t attempts; /* draws of it that had too little capacity */
};

struct mesh_pass {
    const struct mesh *const *meshes; /* a copy of the caller's array, by object */
    struct clusters clusters;
    struct slot slots[SLOT_LIMIT]; /* the first slot_count have a cull; one always has */
    size_t slot_count, slot_limit;
    size_t batch, portion; /* triangles that are settled, and that are drawn, at once */
    GLuint first, all;     /* programs; all: made when first needed */
    GLuint vertices, position_buffer, corner_buffer, positions, corners;
    struct target target; /* without pixels: results go to the buffer */
    GLuint pixel_buffer;
    uint32_t *pixels; /* [pixel_slots n n][2 + capacity]: the shader's nearest, count and triangles; as they go up, */
    const uint32_t *drawn; /* and as they come down */
    struct readback readback;
    size_t pixel_slots; /* that many are drawn and read at once */
    uint32_t capacity;  /* triangles that a pixel can note in one batch */
    GLsizei *draw_counts;
    const void **draw_offsets;
    struct shader_list hits; /* of pixel and triangle */
};

static conus_status create_program(GLuint *out, const struct program_shader *fragment, uint32_t capacity)
{
    const struct program_define defines[] = {{"CAPACITY", capacity},
                                             {"PIXEL_BUFFER", PIXEL_BUFFER},
                                             {"HIT_BUFFER", HIT_BUFFER},
                                             {"POSITION_UNIT", POSITION_UNIT},
                                             {"CORNER_UNIT", CORNER_UNIT}};
    const struct program_source source = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                                          .fragment = *fragment,
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    return program_create(out, &source);
}

/* The program of the nearest triangles, with this capacity in every pixel. */
static conus_status create_first(struct mesh_pass *pass, uint32_t capacity)
{
    const struct program_shader fragment = {"mesh_id.frag.glsl", shader_mesh_id_frag};
    GLuint first = 0;
    conus_status status = create_program(&first, &fragment, capacity);
    if (!status) {
        glDeleteProgram(pass->first);
        pass->first = first;
        pass->capacity = capacity;
    }
    return status;
}

/* The program for all hits, and its list. */
static conus_status create_all(struct mesh_pass *pass)
{
    const struct program_shader fragment = {"mesh_hits.frag.glsl", shader_mesh_hits_frag};
    conus_status status =
        pass->hits.buffer ? CONUS_OK : shader_list_init(&pass->hits, 2 * sizeof(uint32_t), FIRST_HITS);
    return status ? status : create_program(&pass->all, &fragment, 0);
}

/* A buffer, and the texture through which shaders see it. */
static void upload_buffer(GLuint *buffer, GLuint *texture, GLenum format, const void *data, size_t size)
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
    upload_buffer(&pass->position_buffer, &pass->positions, GL_RGB32F, clusters->positions,
                  clusters->vertex_count * 3 * sizeof *clusters->positions);
    upload_buffer(&pass->corner_buffer, &pass->corners, GL_RGB32UI, clusters->corners,
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

/* Makes slots for `wanted` queries, or as many as are allowed. */
static conus_status make_slots(struct mesh_pass *pass, size_t wanted)
{
    conus_status status = CONUS_OK;
    while (pass->slot_count < wanted && pass->slot_count < pass->slot_limit && !status) {
        status = mesh_cull_create(&pass->slots[pass->slot_count].cull, &pass->clusters);
        pass->slot_count += !status;
    }
    return status;
}

static conus_status allocate_pass(struct mesh_pass *pass, const struct mesh *const *meshes, size_t count)
{
    pass->meshes = memory_copy(meshes, count, sizeof(void *));
    if (!pass->meshes) {
        return CONUS_ERROR_MEMORY;
    }
    pass->batch = gl_is_software() ? SOFTWARE_BATCH : BATCH;
    pass->portion = gl_is_software() ? SOFTWARE_PORTION : SIZE_MAX;
    conus_status status = clusters_init(&pass->clusters, meshes, count);
    if (!status) {
        size_t fitting = SLOT_MEMORY / mesh_cull_size(&pass->clusters);
        pass->slot_limit = fitting < 1 ? 1 : fitting < SLOT_LIMIT ? fitting : SLOT_LIMIT;
        status = make_slots(pass, 1);
    }
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
    conus_status status = allocate_pass(pass, meshes, count);
    status = status ? status : create_first(pass, FIRST_CAPACITY);
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
    glDeleteProgram(pass->first);
    glDeleteProgram(pass->all);
    target_finish(&pass->target);
    shader_list_finish(&pass->hits);
    readback_finish(&pass->readback);
    for (size_t i = 0; i < pass->slot_count; i++) {
        mesh_cull_destroy(pass->slots[i].cull);
    }
    clusters_finish(&pass->clusters);
    memory_free((void *)pass->meshes);
    memory_free(pass->pixels);
    memory_free(pass->draw_counts);
    memory_free(pass->draw_offsets);
    memory_free(pass);
}

static size_t pixel_count(const struct mesh_pass *pass)
{
    return (size_t)pass->target.width * pass->target.height;
}

/* Where a pixel of slot number `place` is among those drawn at once. */
static size_t pixel_at(const struct mesh_pass *pass, size_t place, size_t pixel)
{
    return (place * pixel_count(pass) + pixel) * (2 + (size_t)pass->capacity);
}

/* Bytes of the pixels of `slots` slots. */
static size_t pixels_size(const struct mesh_pass *pass, size_t slots)
{
    return slots * pixel_count(pass) * (2 + (size_t)pass->capacity) * sizeof *pass->pixels;
}

/* Reserves the pixels of `slots` slots, or of as many as are allowed. */
static conus_status make_pixels(struct mesh_pass *pass, size_t slots)
{
    size_t fitting = PIXEL_MEMORY / pixels_size(pass, 1);
    slots = slots < fitting ? slots : fitting < 1 ? 1 : fitting;
    if (slots == pass->pixel_slots) {
        return CONUS_OK;
    }
    pass->pixel_slots = 0;
    memory_free(pass->pixels);
    pass->pixels = memory_raw(1, pixels_size(pass, slots));
    if (!pass->pixels) {
        return CONUS_ERROR_MEMORY;
    }
    pass->pixel_slots = slots;
    glNamedBufferData(pass->pixel_buffer, (GLsizeiptr)pixels_size(pass, slots), NULL, GL_DYNAMIC_COPY);
    return gl_check("pixels");
}

static conus_status set_resolution(struct mesh_pass *pass, uint32_t resolution)
{
    if (pass->target.width == resolution) {
        return CONUS_OK;
    }
    pass->pixel_slots = 0;
    target_finish(&pass->target);
    return target_init(&pass->target, resolution, resolution, NULL, 0);
}

/* Eq. 9: nearest first; of equally near ones the lower object, then the lower triangle. */
static void weigh(const struct mesh_pass *pass, const struct mesh_pixels *pixels, size_t pixel, uint32_t drawn)
{
    uint32_t object = clusters_find(&pass->clusters, drawn)->object;
    uint64_t triangle = pass->clusters.triangle[drawn];
    const struct mesh *mesh = pass->meshes[object - 1];
    double t = mesh_distance(mesh, (size_t)triangle, pixels->rays[pixel].origin, pixels->rays[pixel].direction);
    double known = pixels->distances[pixel];
    uint32_t holder = pixels->objects[pixel];
    bool wins_tie = object < holder || (object == holder && triangle < pixels->triangles[pixel]);
    if (t >= 0 && (t < known || (t <= known && wins_tie))) {
        pixels->objects[pixel] = object;
        pixels->distances[pixel] = t;
        pixels->triangles[pixel] = triangle;
    }
}

/* Where the vertex shader places corners. */
static void use_program(GLuint program, const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    const bool parallel = view->radius > 0;
    const double width = parallel ? view->radius : view->slope; /* half the buffer's edge, at depth 1 */
    double rows[9];
    for (int a = 0; a < 3; a++) {
        rows[a] = m[a] / width;
        rows[3 + a] = m[4 + a] / width;
        rows[6 + a] = -m[8 + a];
    }
    glUseProgram(program);
    glUniform3dv(APEX, 1, m + 12);
    glUniformMatrix3dv(DEVICE_FROM_WORLD, 1, GL_TRUE, rows);
    glUniform1i(PARALLEL, parallel);
    glUniform1i(RESOLUTION, (GLint)view->resolution);
}

/* The rays of `first`. */
static void set_rays(const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    double direction[9], origin[6];
    for (int a = 0; a < 3; a++) {
        direction[a] = m[a] * view->slope;
        direction[3 + a] = m[4 + a] * view->slope;
        direction[6 + a] = -m[8 + a];
        origin[a] = m[a] * view->radius;
        origin[3 + a] = m[4 + a] * view->radius;
    }
    glUniformMatrix3dv(DIRECTION_FROM_PLACE, 1, GL_FALSE, direction);
    glUniformMatrix2x3dv(ORIGIN_FROM_PLACE, 1, GL_FALSE, origin);
}

/* Draws with the program in use. */
static void draw_batch(const struct mesh_pass *pass, const uint32_t *batch, size_t count)
{
    target_bind(&pass->target);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glBindTextureUnit(POSITION_UNIT, pass->positions);
    glBindTextureUnit(CORNER_UNIT, pass->corners);
    glBindVertexArray(pass->vertices);
    for (size_t i = 0, portion; i < count; i += portion) {
        size_t triangles = 0;
        for (portion = 0; i + portion < count && triangles < pass->portion; portion++) {
            const struct cluster *cluster = &pass->clusters.cluster[batch[i + portion]];
            pass->draw_counts[portion] = (GLsizei)(3 * cluster->count);
            pass->draw_offsets[portion] = (const void *)((uintptr_t)cluster->first * 3 * sizeof(uint32_t));
            triangles += cluster->count;
        }
        glMultiDrawElements(GL_TRIANGLES, pass->draw_counts, GL_UNSIGNED_INT, pass->draw_offsets, (GLsizei)portion);
        if (pass->portion < SIZE_MAX) {
            glFlush();
        }
    }
}

/* Queries that have not begun. */
struct queue {
    const struct mesh_query *next, *end;
};

/* Gives the slot its query's next batch, or the first one of the next query; false when there is none. */
static bool feed(struct slot *slot, struct queue *queue, size_t batch)
{
    while (!slot->count && (slot->query || queue->next < queue->end)) {
        if (!slot->query) {
            slot->query = queue->next++;
            mesh_cull_begin(slot->cull, &slot->query->view);
        }
        mesh_cull_hide(slot->cull, slot->query->pixels.distances);
        slot->count = mesh_cull_batch(&slot->batch, slot->cull, batch);
        slot->attempts = 0;
        slot->query = slot->count ? slot->query : NULL;
    }
    return slot->count > 0;
}

/* Feeds the slots, moves those under way to the front, and returns how many they are. */
static size_t feed_all(struct mesh_pass *pass, size_t slots, struct queue *queue)
{
    for (size_t i = 0; i < slots;) {
        if (feed(&pass->slots[i], queue, pass->batch)) {
            i++;
        } else {
            struct slot idle = pass->slots[i];
            pass->slots[i] = pass->slots[--slots];
            pass->slots[slots] = idle;
        }
    }
    return slots;
}

/* Draws the slots' batches and reads the pixels. */
static conus_status draw_batches(struct mesh_pass *pass, const struct slot *slots, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t pixel = 0; pixel < pixel_count(pass); pixel++) {
            float nearest = (float)slots[i].query->pixels.distances[pixel];
            uint32_t *first = pass->pixels + pixel_at(pass, i, pixel);
            memcpy(first, &nearest, sizeof nearest);
            first[1] = 0;
        }
    }
    glNamedBufferSubData(pass->pixel_buffer, 0, (GLsizeiptr)pixels_size(pass, count), pass->pixels);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, PIXEL_BUFFER, pass->pixel_buffer);
    for (size_t i = 0; i < count; i++) {
        use_program(pass->first, &slots[i].query->view);
        set_rays(&slots[i].query->view);
        glUniform1i(FIRST_PIXEL, (GLint)(i * pixel_count(pass)));
        draw_batch(pass, slots[i].batch, slots[i].count);
    }
    struct readback_part part = {pass->pixel_buffer, pixels_size(pass, count), NULL};
    conus_status status = readback_wait(&pass->readback, &part, 1, "mesh ID pass");
    pass->drawn = part.data;
    return status;
}

/* Settles the triangles that the driver noted in the slots' pixels. A batch is drawn again if a pixel had more
 * triangles than its capacity. The hits known by then leave most of them out; if that is not enough, the capacity
 * grows. */
static conus_status settle_batches(struct mesh_pass *pass, struct slot *slots, size_t count)
{
    uint32_t wanted = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t most = 0; /* that one pixel noted */
        for (size_t n = 0; n < pixel_count(pass); n++) {
            const uint32_t *pixel = pass->drawn + pixel_at(pass, i, n);
            uint32_t noted = pixel[1];
            most = noted > most ? noted : most;
            for (uint32_t k = 0; k < noted && k < pass->capacity; k++) {
                weigh(pass, &slots[i].query->pixels, n, pixel[2 + k]);
            }
        }
        if (most <= pass->capacity) {
            slots[i].count = 0;
        } else if (++slots[i].attempts > 1 && most > wanted) {
            wanted = most;
        }
    }
    if (!wanted) {
        return CONUS_OK;
    }
    size_t places = pass->pixel_slots;
    conus_status status = create_first(pass, (wanted + 2 + CAPACITY_STEP - 1) / CAPACITY_STEP * CAPACITY_STEP - 2);
    pass->pixel_slots = 0; /* those are too small */
    return status ? status : make_pixels(pass, places);
}

conus_status mesh_pass_render(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    struct queue queue = {queries, queries + count};
    conus_status status = count ? set_resolution(pass, queries->view.resolution) : CONUS_OK;
    status = status ? status : make_slots(pass, count);
    size_t slots = count < pass->slot_count ? count : pass->slot_count;
    if (!status && pass->pixel_slots < slots) {
        status = make_pixels(pass, slots);
    }
    for (size_t i = 0; i < slots; i++) { /* left over from a query that failed */
        pass->slots[i].query = NULL;
        pass->slots[i].count = 0;
    }
    while (!status && (slots = feed_all(pass, slots, &queue)) > 0) {
        for (size_t first = 0, together; first < slots && !status; first += together) {
            together = slots - first < pass->pixel_slots ? slots - first : pass->pixel_slots;
            status = draw_batches(pass, &pass->slots[first], together);
            status = status ? status : settle_batches(pass, &pass->slots[first], together);
        }
    }
    return status;
}

/* Draws clusters until all their hits are taken. */
static conus_status pierce_batch(struct mesh_pass *pass, const struct mesh_view *view, const uint32_t *batch,
                                 size_t batch_count, mesh_pass_take take, void *user)
{
    struct shader_list *list = &pass->hits;
    conus_status status = CONUS_OK;
    uint32_t per_pixel = 0;
    for (size_t i = 0; i < batch_count; i++) {
        per_pixel += pass->clusters.cluster[batch[i]].count;
    }
    shader_list_begin(list, view->resolution * view->resolution, per_pixel);
    while (!status && shader_list_next(list, HIT_BUFFER)) {
        const void *records = NULL;
        uint32_t count = 0;
        use_program(pass->all, view);
        glUniform2i(PIXELS, (GLint)list->first, (GLint)list->end);
        draw_batch(pass, batch, batch_count);
        status = shader_list_read(list, &records, &count);
        for (uint32_t i = 0; i < count && !status; i++) {
            const uint32_t *record = (const uint32_t *)records + 2 * (size_t)i;
            const struct mesh_pass_hit hit = {record[0], clusters_find(&pass->clusters, record[1])->object,
                                              pass->clusters.triangle[record[1]]};
            status = take(user, &hit);
        }
    }
    return status;
}

conus_status mesh_pass_pierce(struct mesh_pass *pass, const struct mesh_view *view, mesh_pass_take take, void *user)
{
    uint32_t pixels = view->resolution * view->resolution;
    size_t countable = UINT32_MAX / pixels - CLUSTER_TRIANGLES; /* at once for all pixels, see shader_list.h */
    size_t triangles = countable < PIERCE_BATCH ? countable : PIERCE_BATCH;
    conus_status status = pass->all ? CONUS_OK : create_all(pass);
    status = status ? status : set_resolution(pass, view->resolution);
    struct mesh_cull *cull = pass->slots[0].cull;
    const uint32_t *batch;
    mesh_cull_begin(cull, view);
    mesh_cull_hide(cull, NULL);
    for (size_t count; !status && (count = mesh_cull_batch(&batch, cull, triangles)) > 0;) {
        status = pierce_batch(pass, view, batch, count, take, user);
    }
    return status;
}
