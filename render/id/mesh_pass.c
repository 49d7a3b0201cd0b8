/* SPDX-License-Identifier: BSD-3-Clause */
/* Lets the device draw the clusters that a view can show, reads the proposed triangles and decides which is nearest. */
#include "render/id/id_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/gl/gl.h"
#include "render/gl/shaders.h"

#include <string.h>

enum kind { CULL, FIRST, ALL, KIND_COUNT }; /* of programs; ALL: made when first needed */

/* Buffers that shaders see as textures, of the units of the same numbers; and others, which they see as blocks of these
 * numbers, of which OpenGL promises 8. The list of hits has the first. */
enum {
    POSITIONS,
    CORNERS,
    BALLS,
    CLUSTERS,
    TEXTURE_COUNT,
    PIXELS = TEXTURE_COUNT,
    INDICES, /* what is drawn now */
    SHOWN,   /* ranges, and */
    DRAWS,   /* draws, as below */
    BUFFER_COUNT
};
enum { HITS };

/* Locations of uniforms: of all programs, of CULL, of FIRST, and of ALL. */
enum { APEX, DEVICE_FROM_WORLD, PARALLEL, RESOLUTION, OWN };
enum { SHAPE = OWN, KNOWN, CULLED, CLUSTER_COUNT };
enum { DIRECTION_FROM_PLACE = OWN, ORIGIN_FROM_PLACE, FIRST_PIXEL, NOTES };
enum { DRAWN_PIXELS = OWN };
enum { FIRST_CAPACITY = 6, CAPACITY_STEP = 8, FIRST_HITS = 1024 };

/* Ranges of clusters that are culled and drawn at once, at most. */
enum { BATCH = 512 };

/* Of a query, batches of 1, 2, 4, ... BATCH ranges, nearest first, so that those behind are culled by what is known by
 * then; and one for the notes. Each BATCH more ranges make one more of both. */
enum { BATCHES_OF_QUERY = 10 + 1 + 1 };

/* Queries are drawn and read at once while their pixels take at most so many bytes. */
enum { PIXEL_MEMORY = 1 << 24 };

/* A range of clusters that a query can show. */
struct shown {
    double nearest; /* mm: a lower bound of its distance from the apex */
    uint32_t range;
};

/* A command of glDrawElementsIndirect(). */
struct draw {
    uint32_t count, instances, first, base, base_instance;
};

struct mesh_pass {
    const struct mesh *const *meshes; /* a copy of the caller's array, by object */
    struct clusters clusters;
    GLuint programs[KIND_COUNT], buffers[BUFFER_COUNT], textures[TEXTURE_COUNT];
    GLuint vertices;
    struct target target; /* without pixels: results go to the buffer */
    uint32_t *pixels; /* [pixel_slots n n][2 + capacity]: the shader's nearest, count and triangles; as they go up, */
    const uint32_t *drawn; /* and as they come down */
    struct readback readback;
    size_t pixel_slots;  /* queries that are drawn and read at once */
    uint32_t capacity;   /* triangles that a pixel can note */
    struct shown *shown; /* [range_count] of one query, nearest first */
    uint32_t *ranges;    /* those of all queries that are drawn at once, query after query */
    size_t *ends;        /* of each query */
    struct draw *draws;  /* of each batch of them */
    size_t range_capacity, end_capacity, draw_capacity;
    struct shader_list hits; /* of pixel and triangle */
};

/* Makes a program; FIRST has this capacity in every pixel. */
static conus_status create_program(struct mesh_pass *pass, enum kind kind, uint32_t capacity)
{
    static const struct program_source shaders[KIND_COUNT] = {
        [CULL] = {.compute = {"mesh_cull.comp.glsl", shader_mesh_cull_comp}},
        [FIRST] = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                   .fragment = {"mesh_id.frag.glsl", shader_mesh_id_frag}},
        [ALL] = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                 .fragment = {"mesh_hits.frag.glsl", shader_mesh_hits_frag}}};
    const struct program_define defines[] = {{"CAPACITY", capacity},
                                             {"CLUSTER_RANGE", CLUSTER_RANGE},
                                             {"CLUSTER_GROUP", CLUSTER_GROUP},
                                             {"PIXEL_BUFFER", PIXELS},
                                             {"HIT_BUFFER", HITS},
                                             {"INDEX_BUFFER", INDICES},
                                             {"SHOWN_BUFFER", SHOWN},
                                             {"DRAW_BUFFER", DRAWS},
                                             {"POSITION_UNIT", POSITIONS},
                                             {"CORNER_UNIT", CORNERS},
                                             {"BALL_UNIT", BALLS},
                                             {"CLUSTER_UNIT", CLUSTERS}};
    struct program_source source = shaders[kind];
    source.defines = defines;
    source.define_count = sizeof defines / sizeof defines[0];
    GLuint program = 0;
    conus_status status = program_create(&program, &source);
    if (!status) {
        glDeleteProgram(pass->programs[kind]);
        pass->programs[kind] = program;
        pass->capacity = kind == FIRST ? capacity : pass->capacity;
    }
    return status;
}

/* Uploads the triangles; afterwards only the driver has them. */
static conus_status upload_triangles(struct mesh_pass *pass, uint64_t *memory_left)
{
    struct clusters *clusters = &pass->clusters;
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    const size_t listed = clusters->range_count < BATCH ? clusters->range_count : BATCH;
    const size_t index_size = listed * CLUSTER_RANGE * CLUSTER_TRIANGLES * 3 * sizeof(uint32_t);
    const struct {
        GLenum format;
        const void *data;
        size_t size;
    } parts[TEXTURE_COUNT] = {
        [POSITIONS] = {GL_RGB32F, clusters->positions, clusters->vertex_count * 3 * sizeof *clusters->positions},
        [CORNERS] = {GL_RGB32UI, clusters->corners, clusters->triangle_count * 3 * sizeof *clusters->corners},
        [BALLS] = {GL_RGBA32F, clusters->balls,
                   (clusters->cluster_count + clusters->group_count) * 4 * sizeof *clusters->balls},
        [CLUSTERS] = {GL_RGB32UI, clusters->cluster, clusters->cluster_count * sizeof *clusters->cluster}};
    uint64_t size = index_size;
    for (int i = 0; i < TEXTURE_COUNT; i++) {
        size += parts[i].size;
    }
    if (clusters->vertex_count > (size_t)limit) {
        return fail(CONUS_ERROR_GL, "meshes of %zu triangles: this driver allows some %d", clusters->triangle_count,
                    limit);
    }
    if (size > *memory_left) {
        return fail(CONUS_ERROR_MEMORY, "meshes of %zu triangles: %llu bytes, allowed are %llu more",
                    clusters->triangle_count, (unsigned long long)size, (unsigned long long)*memory_left);
    }
    *memory_left -= size;
    glCreateBuffers(BUFFER_COUNT, pass->buffers);
    glCreateTextures(GL_TEXTURE_BUFFER, TEXTURE_COUNT, pass->textures);
    for (int i = 0; i < TEXTURE_COUNT; i++) {
        glNamedBufferStorage(pass->buffers[i], (GLsizeiptr)parts[i].size, parts[i].data, 0);
        glTextureBuffer(pass->textures[i], parts[i].format, pass->buffers[i]);
    }
    glNamedBufferStorage(pass->buffers[INDICES], (GLsizeiptr)index_size, NULL, 0);
    glCreateVertexArrays(1, &pass->vertices);
    glVertexArrayVertexBuffer(pass->vertices, 0, pass->buffers[POSITIONS], 0, 3 * sizeof *clusters->positions);
    glVertexArrayElementBuffer(pass->vertices, pass->buffers[INDICES]);
    glVertexArrayAttribFormat(pass->vertices, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(pass->vertices, 0, 0);
    glEnableVertexArrayAttrib(pass->vertices, 0);
    clusters_drop_triangles(clusters);
    return gl_check("meshes");
}

conus_status mesh_pass_create(struct mesh_pass **out, const struct mesh *const *meshes, size_t count,
                              uint64_t *memory_left)
{
    struct mesh_pass *pass = memory_zeroed(1, sizeof *pass);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    pass->meshes = memory_copy(meshes, count, sizeof(void *));
    conus_status status = pass->meshes ? clusters_init(&pass->clusters, meshes, count) : CONUS_ERROR_MEMORY;
    if (!status) {
        pass->shown = memory_raw(pass->clusters.range_count, sizeof *pass->shown);
        status = pass->shown ? create_program(pass, CULL, 0) : CONUS_ERROR_MEMORY;
    }
    status = status ? status : create_program(pass, FIRST, FIRST_CAPACITY);
    status = status ? status : shader_list_init(&pass->hits, 2 * sizeof(uint32_t), FIRST_HITS);
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
    glDeleteTextures(TEXTURE_COUNT, pass->textures);
    glDeleteBuffers(BUFFER_COUNT, pass->buffers);
    glDeleteVertexArrays(1, &pass->vertices);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        glDeleteProgram(pass->programs[kind]);
    }
    target_finish(&pass->target);
    shader_list_finish(&pass->hits);
    readback_finish(&pass->readback);
    clusters_finish(&pass->clusters);
    memory_free((void *)pass->meshes);
    memory_free(pass->pixels);
    memory_free(pass->shown);
    memory_free(pass->ranges);
    memory_free(pass->ends);
    memory_free(pass->draws);
    memory_free(pass);
}

static size_t pixel_count(const struct mesh_pass *pass)
{
    return (size_t)pass->target.width * pass->target.height;
}

/* Where a pixel of query number `place` is among those drawn at once. */
static size_t pixel_at(const struct mesh_pass *pass, size_t place, size_t pixel)
{
    return (place * pixel_count(pass) + pixel) * (2 + (size_t)pass->capacity);
}

/* Bytes of the pixels of `slots` queries. */
static size_t pixels_size(const struct mesh_pass *pass, size_t slots)
{
    return slots * pixel_count(pass) * (2 + (size_t)pass->capacity) * sizeof *pass->pixels;
}

/* Reserves the pixels of `slots` queries, or of as many as are allowed. */
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
    glNamedBufferData(pass->buffers[PIXELS], (GLsizeiptr)pixels_size(pass, slots), NULL, GL_DYNAMIC_COPY);
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

/* Where the device is, and where it looks, for a program. */
static void set_view(GLuint program, const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    const bool parallel = view->radius > 0;
    const double edge = parallel ? view->radius : view->slope; /* half the buffer's, at depth 1 */
    double rows[9];
    for (int a = 0; a < 3; a++) {
        rows[a] = m[a] / edge;
        rows[3 + a] = m[4 + a] / edge;
        rows[6 + a] = -m[8 + a];
    }
    glUseProgram(program);
    glUniform3dv(APEX, 1, m + 12);
    glUniformMatrix3dv(DEVICE_FROM_WORLD, 1, GL_TRUE, rows);
    glUniform1i(PARALLEL, parallel);
    glUniform1i(RESOLUTION, (GLint)view->resolution);
}

/* What CULL leaves out: `known` is the first pixel of the query, and the words of each; 0 where nothing is known. */
static void set_culling(const struct mesh_pass *pass, const struct mesh_view *view, GLint first_pixel, GLint stride)
{
    const double cosine = 1 / sqrt(1 + view->slope * view->slope);
    const double shape[3] = {view->radius > 0 ? view->radius : view->slope, cosine, view->slope * cosine};
    set_view(pass->programs[CULL], view);
    glUniform3dv(SHAPE, 1, shape);
    glUniform2i(KNOWN, first_pixel, stride);
    glUniform1i(CLUSTER_COUNT, (GLint)pass->clusters.cluster_count);
}

/* The rays of FIRST. */
static void set_first(const struct mesh_pass *pass, const struct mesh_view *view, GLint first_pixel)
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
    set_view(pass->programs[FIRST], view);
    glUniformMatrix3dv(DIRECTION_FROM_PLACE, 1, GL_FALSE, direction);
    glUniformMatrix2x3dv(ORIGIN_FROM_PLACE, 1, GL_FALSE, origin);
    glUniform1i(FIRST_PIXEL, first_pixel);
}

static int nearest_first(const void *a, const void *b)
{
    return compare_double(((const struct shown *)a)->nearest, ((const struct shown *)b)->nearest);
}

/* Lists the ranges that a view can show as pass->shown. Returns how many there are. */
static size_t list_shown(const struct mesh_pass *pass, const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    const double cosine = 1 / sqrt(1 + view->slope * view->slope);
    size_t count = 0;
    for (size_t range = 0; range < pass->clusters.range_count; range++) {
        const float *ball = &pass->clusters.range_balls[4 * range];
        const double radius = (double)ball[3];
        const double at[3] = {(double)ball[0] - m[12], (double)ball[1] - m[13], (double)ball[2] - m[14]};
        const double depth = -vec3_dot(at, m + 8);
        const double outside = fmax(fabs(vec3_dot(at, m)), fabs(vec3_dot(at, m + 4))) - view->radius;
        if (depth > -radius && outside * cosine - depth * view->slope * cosine < radius) {
            pass->shown[count++] = (struct shown){vec3_length(at) - radius, (uint32_t)range};
        }
    }
    order_sort(pass->shown, count, sizeof *pass->shown, nearest_first);
    return count;
}

/* Sends the ranges of queries to the device, and empty draws for as many batches as they can make. */
static conus_status upload_ranges(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    size_t end = 0;
    if (!memory_reserve(&pass->ends, &pass->end_capacity, count, sizeof *pass->ends)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const size_t added = list_shown(pass, &queries[i].view);
        if (!memory_reserve(&pass->ranges, &pass->range_capacity, end + added, sizeof *pass->ranges)) {
            return CONUS_ERROR_MEMORY;
        }
        for (size_t k = 0; k < added; k++) {
            pass->ranges[end++] = pass->shown[k].range;
        }
        pass->ends[i] = end;
    }
    const size_t draws = count * BATCHES_OF_QUERY + 2 * (end / BATCH);
    if (!memory_reserve(&pass->draws, &pass->draw_capacity, draws, sizeof *pass->draws)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < draws; i++) {
        pass->draws[i] = (struct draw){.instances = 1};
    }
    glNamedBufferData(pass->buffers[SHOWN], (GLsizeiptr)(end * sizeof *pass->ranges), pass->ranges, GL_DYNAMIC_COPY);
    glNamedBufferData(pass->buffers[DRAWS], (GLsizeiptr)(draws * sizeof *pass->draws), pass->draws, GL_DYNAMIC_COPY);
    return gl_check("ranges of triangles");
}

/* What culling and drawing read and write. */
static void bind_all(const struct mesh_pass *pass)
{
    target_bind(&pass->target);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glBindVertexArray(pass->vertices);
    for (GLuint i = 0; i < TEXTURE_COUNT; i++) {
        glBindTextureUnit(i, pass->textures[i]);
    }
    for (GLuint i = TEXTURE_COUNT; i < BUFFER_COUNT; i++) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, pass->buffers[i]);
    }
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, pass->buffers[DRAWS]);
}

/* Lists for a draw what the view set shows of ranges. */
static void cull_batch(const struct mesh_pass *pass, size_t first, size_t count, size_t draw)
{
    glUseProgram(pass->programs[CULL]);
    glUniform2i(CULLED, (GLint)first, (GLint)(draw * sizeof(struct draw) / sizeof(uint32_t)));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute((GLuint)count, 1, 1);
    glMemoryBarrier(GL_ELEMENT_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

/* Draws what was listed with a program. */
static void draw_batch(GLuint program, size_t draw)
{
    glUseProgram(program);
    glDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(uintptr_t)(draw * sizeof(struct draw)));
}

/* Sends the pixels of queries to the device, with what is known of their distances. */
static void upload_pixels(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t pixel = 0; pixel < pixel_count(pass); pixel++) {
            float nearest = (float)queries[i].pixels.distances[pixel];
            uint32_t *first = pass->pixels + pixel_at(pass, i, pixel);
            memcpy(first, &nearest, sizeof nearest);
            first[1] = 0;
        }
    }
    glNamedBufferSubData(pass->buffers[PIXELS], 0, (GLsizeiptr)pixels_size(pass, count), pass->pixels);
}

/* Draws queries and reads their pixels. Each is drawn twice: for the distances, and to note who is that near. */
static conus_status draw_queries(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    conus_status status = upload_ranges(pass, queries, count);
    if (status) {
        return status;
    }
    upload_pixels(pass, queries, count);
    bind_all(pass);
    size_t draw = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t first_pixel = i * pixel_count(pass);
        const GLint stride = 2 + (GLint)pass->capacity;
        set_culling(pass, &queries[i].view, (GLint)first_pixel * stride, stride);
        set_first(pass, &queries[i].view, (GLint)first_pixel);
        for (int notes = 0; notes < 2; notes++) {
            size_t size = notes ? BATCH : 1;
            glUseProgram(pass->programs[FIRST]);
            glUniform1i(NOTES, notes);
            for (size_t k = i ? pass->ends[i - 1] : 0, batch; k < pass->ends[i]; k += batch, draw++) {
                batch = size < pass->ends[i] - k ? size : pass->ends[i] - k;
                cull_batch(pass, k, batch, draw);
                draw_batch(pass->programs[FIRST], draw);
                size = 2 * size < BATCH ? 2 * size : BATCH;
            }
        }
    }
    struct readback_part part = {pass->buffers[PIXELS], pixels_size(pass, count), NULL};
    status = readback_wait(&pass->readback, &part, 1, "mesh ID pass");
    pass->drawn = part.data;
    return status;
}

/* Settles the triangles that the driver noted in the queries' pixels. Returns how many one pixel has at most. */
static uint32_t settle_queries(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t n = 0; n < pixel_count(pass); n++) {
            const uint32_t *pixel = pass->drawn + pixel_at(pass, i, n);
            most = pixel[1] > most ? pixel[1] : most;
            for (uint32_t k = 0; k < pixel[1] && k < pass->capacity; k++) {
                weigh(pass, &queries[i].pixels, n, pixel[2 + k]);
            }
        }
    }
    return most;
}

conus_status mesh_pass_render(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    conus_status status = count ? set_resolution(pass, queries->view.resolution) : CONUS_OK;
    for (size_t first = 0, together; first < count && !status; first += together) {
        uint32_t most = 0;
        status = pass->pixel_slots < count - first ? make_pixels(pass, count - first) : CONUS_OK;
        together = pass->pixel_slots < count - first ? pass->pixel_slots : count - first;
        status = status ? status : draw_queries(pass, queries + first, together);
        most = status ? 0 : settle_queries(pass, queries + first, together);
        if (most > pass->capacity) { /* they are drawn again */
            status = create_program(pass, FIRST, (most + 2 + CAPACITY_STEP - 1) / CAPACITY_STEP * CAPACITY_STEP - 2);
            pass->pixel_slots = 0; /* those are too small */
            together = 0;
        }
    }
    return status;
}

/* Draws what was listed, of which a pixel may have `triangles`, until all hits are taken. */
static conus_status take_hits(struct mesh_pass *pass, const struct mesh_view *view, size_t draw, uint32_t triangles,
                              mesh_pass_take take, void *user)
{
    struct shader_list *list = &pass->hits;
    conus_status status = CONUS_OK;
    shader_list_begin(list, view->resolution * view->resolution, triangles);
    while (!status && shader_list_next(list, HITS)) {
        const void *records = NULL;
        uint32_t count = 0;
        glUseProgram(pass->programs[ALL]);
        glUniform2i(DRAWN_PIXELS, (GLint)list->first, (GLint)list->end);
        draw_batch(pass->programs[ALL], draw);
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
    const struct mesh_query query = {.view = *view};
    conus_status status = pass->programs[ALL] ? CONUS_OK : create_program(pass, ALL, 0);
    status = status ? status : set_resolution(pass, view->resolution);
    status = status ? status : upload_ranges(pass, &query, 1);
    if (status) {
        return status;
    }
    bind_all(pass);
    set_culling(pass, view, 0, 0);
    set_view(pass->programs[ALL], view);
    for (size_t k = 0, draw = 0, batch; k < pass->ends[0] && !status; k += batch, draw++) {
        struct readback_part part = {pass->buffers[DRAWS], (draw + 1) * sizeof *pass->draws, NULL};
        batch = BATCH < pass->ends[0] - k ? BATCH : pass->ends[0] - k;
        cull_batch(pass, k, batch, draw);
        status = readback_wait(&pass->readback, &part, 1, "culling");
        status =
            status ? status : take_hits(pass, view, draw, ((const struct draw *)part.data)[draw].count / 3, take, user);
    }
    return status;
}
