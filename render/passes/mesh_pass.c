/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws the clusters that a view can show, reads the proposed triangles and decides which is nearest. */
#include "render/passes/id_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/gl/gl.h"

#include <string.h>

enum kind { FIRST, ALL, KIND_COUNT }; /* of programs; ALL: made when first needed */

/* Buffers that shaders see as textures, of the units of the same numbers; and one that they see as a block of that
 * number. The list of hits has the first. */
enum { POSITIONS, CORNERS, TEXTURE_COUNT, PIXELS = TEXTURE_COUNT, BUFFER_COUNT };
enum { HITS };

/* Locations of uniforms: of all programs, of FIRST, and of ALL. */
enum { APEX, DEVICE_FROM_WORLD, PARALLEL, RESOLUTION, OWN };
enum { DIRECTION_FROM_PLACE = OWN, ORIGIN_FROM_PLACE, FIRST_PIXEL };
enum { DRAWN_PIXELS = OWN };
enum { FIRST_CAPACITY = 6, CAPACITY_STEP = 8, FIRST_HITS = 1024 };

/* Pixels that a driver's grid of vertices may move an edge by, and a margin; relative error of distances that
 * comparisons allow for; pixels of a ball that are not asked one by one. */
#define MARGIN 0.02
#define ROUNDING 1e-9
enum { MANY_PIXELS = 64 };

/* Clusters that are drawn at once: Mesa's llvmpipe keeps triangles until it draws them, and of thousands each costs two
 * to three times as much as of hundreds. */
enum { PORTION = 64 };

/* Ranges of clusters of which all hits are listed at once. */
enum { BATCH = 16 };

/* Queries are drawn and read at once while their pixels take at most so many bytes. */
enum { PIXEL_MEMORY = 1 << 24 };

/* A range of clusters that a query can show. */
struct shown {
    double nearest; /* mm: a lower bound of its distance from the apex */
    uint32_t range;
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
    struct shown *shown; /* ranges of all queries that are drawn at once, query after query, nearest first */
    size_t *ends;        /* of each query */
    size_t shown_capacity, end_capacity;
    GLsizei *counts;      /* [cluster_count] of corners, of the clusters that are drawn now, */
    const void **offsets; /* and where their corners are */
    size_t drawn_count;
    uint32_t triangles;      /* of them */
    struct shader_list hits; /* of pixel and triangle */
};

/* Makes a program; FIRST has this capacity in every pixel. */
static conus_status create_program(struct mesh_pass *pass, enum kind kind, uint32_t capacity)
{
    static const struct program_source shaders[KIND_COUNT] = {
        [FIRST] = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                   .fragment = {"mesh_id.frag.glsl", shader_mesh_id_frag}},
        [ALL] = {.vertex = {"mesh_id.vert.glsl", shader_mesh_id_vert},
                 .fragment = {"mesh_hits.frag.glsl", shader_mesh_hits_frag}}};
    const struct program_define defines[] = {{"CAPACITY", capacity},
                                             {"PIXEL_BUFFER", PIXELS},
                                             {"HIT_BUFFER", HITS},
                                             {"POSITION_UNIT", POSITIONS},
                                             {"CORNER_UNIT", CORNERS}};
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
    const struct {
        GLenum format;
        const void *data;
        size_t size;
    } parts[TEXTURE_COUNT] = {
        [POSITIONS] = {GL_RGB32F, clusters->positions, clusters->vertex_count * 3 * sizeof *clusters->positions},
        [CORNERS] = {GL_RGB32UI, clusters->corners, clusters->triangle_count * 3 * sizeof *clusters->corners}};
    uint64_t size = 0;
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
    glCreateVertexArrays(1, &pass->vertices);
    glVertexArrayVertexBuffer(pass->vertices, 0, pass->buffers[POSITIONS], 0, 3 * sizeof *clusters->positions);
    glVertexArrayElementBuffer(pass->vertices, pass->buffers[CORNERS]);
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
        pass->counts = memory_raw(pass->clusters.cluster_count, sizeof *pass->counts);
        pass->offsets = memory_raw(pass->clusters.cluster_count, sizeof *pass->offsets);
        status = pass->counts && pass->offsets ? create_program(pass, FIRST, FIRST_CAPACITY) : CONUS_ERROR_MEMORY;
    }
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
    memory_free(pass->ends);
    memory_free(pass->counts);
    memory_free((void *)pass->offsets);
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

/* A ball in the device's frame: to its right, up and forward. */
struct seen {
    double at[3], radius;
};

static struct seen see(const struct mesh_view *view, const float ball[4])
{
    const double *m = view->world_from_device;
    const double at[3] = {(double)ball[0] - m[12], (double)ball[1] - m[13], (double)ball[2] - m[14]};
    return (struct seen){{vec3_dot(at, m), vec3_dot(at, m + 4), -vec3_dot(at, m + 8)}, (double)ball[3]};
}

/* Whether the ball is in the buffer's pyramid, the square one around the cone, or a cylinder's prism. */
static bool is_in_view(const struct mesh_view *view, const struct seen *ball)
{
    const double cosine = 1 / sqrt(1 + view->slope * view->slope);
    const double outside = fmax(fabs(ball->at[0]), fabs(ball->at[1])) - view->radius;
    return ball->at[2] > -ball->radius && (outside - ball->at[2] * view->slope) * cosine < ball->radius;
}

/* A lower bound of its distance along any ray: those of a cylinder go to both sides, or only ahead. */
static double nearest_of(const struct mesh_view *view, const struct seen *ball)
{
    const double away = view->radius > 0 ? fabs(ball->at[2]) : vec3_length(ball->at);
    return away * (1 - ROUNDING) - ball->radius * (1 + ROUNDING);
}

/* The first and the last pixel whose centre the ball may cover along one axis; the last is before the first if none. */
static void find_pixels(int out[2], const struct mesh_view *view, double offset, const struct seen *ball)
{
    const double n = view->resolution;
    const double near = view->radius + view->slope * (ball->at[2] - ball->radius); /* half the buffer's edge there */
    const double far = view->radius + view->slope * (ball->at[2] + ball->radius);
    const double low = offset - ball->radius;
    const double high = offset + ball->radius;
    out[0] = 0;
    out[1] = (int)view->resolution - 1;
    if (near > 0) {
        out[0] = (int)fmin(fmax(ceil(((low / (low < 0 ? near : far) + 1) * n - 1) / 2 - MARGIN), 0), n);
        out[1] = (int)fmin(fmax(floor(((high / (high > 0 ? near : far) + 1) * n - 1) / 2 + MARGIN), -1), n - 1);
    }
}

/* Whether the ray of a pixel passes the ball, or so near that a driver may think so. */
static bool passes(const struct mesh_view *view, const struct seen *ball, int i, int j)
{
    const double edge = view->radius > 0 ? view->radius : view->slope;
    const double right = ((2 * i + 1) / (double)view->resolution - 1) * edge;
    const double up = ((2 * j + 1) / (double)view->resolution - 1) * edge;
    const double far = ball->at[2] + ball->radius;
    const double pixel = 2 * (view->radius + view->slope * far) / view->resolution;
    const double reach = ball->radius + 2 * MARGIN * pixel + ROUNDING * fabs(far);
    double off[3] = {ball->at[0] - right, ball->at[1] - up, 0};
    double square = 1;
    if (view->radius <= 0) { /* the cross product, in which nothing cancels */
        off[0] = ball->at[1] - ball->at[2] * up;
        off[1] = ball->at[2] * right - ball->at[0];
        off[2] = up * ball->at[0] - right * ball->at[1];
        square += right * right + up * up;
    }
    return vec3_dot(off, off) <= reach * reach * square;
}

/* Whether a ball may show before what each pixel has hit; before nothing, where `distances` is NULL. */
static bool is_visible(const struct mesh_view *view, const double *distances, const float ball[4])
{
    const struct seen seen = see(view, ball);
    int across[2];
    int up[2];
    if (!is_in_view(view, &seen)) {
        return false;
    }
    find_pixels(across, view, seen.at[0], &seen);
    find_pixels(up, view, seen.at[1], &seen);
    const bool is_large = (across[1] - across[0] + 1) * (up[1] - up[0] + 1) > MANY_PIXELS;
    const double nearest = nearest_of(view, &seen);
    bool visible = false;
    for (int j = up[0]; j <= up[1] && !visible; j++) {
        for (int i = across[0]; i <= across[1] && !visible; i++) {
            visible = (!distances || distances[(size_t)j * view->resolution + (size_t)i] >= nearest) &&
                      (is_large || seen.at[2] <= seen.radius || passes(view, &seen, i, j));
        }
    }
    return visible;
}

static int nearest_first(const void *a, const void *b)
{
    return compare_double(((const struct shown *)a)->nearest, ((const struct shown *)b)->nearest);
}

/* Lists the ranges that queries can show. */
static conus_status list_shown(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    size_t end = 0;
    if (!memory_reserve(&pass->ends, &pass->end_capacity, count, sizeof *pass->ends)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        const size_t first = end;
        if (!memory_reserve(&pass->shown, &pass->shown_capacity, end + pass->clusters.range_count,
                            sizeof *pass->shown)) {
            return CONUS_ERROR_MEMORY;
        }
        for (size_t range = 0; range < pass->clusters.range_count; range++) {
            const struct seen seen = see(&queries[i].view, &pass->clusters.range_balls[4 * range]);
            if (is_in_view(&queries[i].view, &seen)) {
                pass->shown[end++] = (struct shown){nearest_of(&queries[i].view, &seen), (uint32_t)range};
            }
        }
        order_sort(pass->shown + first, end - first, sizeof *pass->shown, nearest_first);
        pass->ends[i] = end;
    }
    return CONUS_OK;
}

/* Appends the clusters of a range that may be visible to those that are drawn. */
static void add_range(struct mesh_pass *pass, const struct mesh_view *view, const double *distances, uint32_t range)
{
    const struct clusters *clusters = &pass->clusters;
    const float *groups = clusters->balls + 4 * clusters->cluster_count;
    const size_t first = (size_t)range * CLUSTER_RANGE;
    const size_t end =
        clusters->cluster_count - first < CLUSTER_RANGE ? clusters->cluster_count : first + CLUSTER_RANGE;
    for (size_t k = first; k < end; k++) {
        if (k % CLUSTER_GROUP == 0 && !is_visible(view, distances, groups + k / CLUSTER_GROUP * 4)) {
            k += CLUSTER_GROUP - 1;
        } else if (is_visible(view, distances, clusters->balls + 4 * k)) {
            pass->counts[pass->drawn_count] = (GLsizei)(3 * clusters->cluster[k].count);
            pass->offsets[pass->drawn_count++] =
                (const void *)((uintptr_t)clusters->cluster[k].first * 3 * sizeof(uint32_t));
            pass->triangles += clusters->cluster[k].count;
        }
    }
}

/* Lists the clusters of ranges number `first` to `end` - 1 that may be visible, to be drawn. */
static void list_clusters(struct mesh_pass *pass, const struct mesh_view *view, const double *distances, size_t first,
                          size_t end)
{
    pass->drawn_count = 0;
    pass->triangles = 0;
    for (size_t k = first; k < end; k++) {
        add_range(pass, view, distances, pass->shown[k].range);
    }
}

/* What drawing reads and writes. */
static void bind_all(const struct mesh_pass *pass)
{
    target_bind(&pass->target);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
    glBindVertexArray(pass->vertices);
    glBindTextures(0, TEXTURE_COUNT, pass->textures);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, PIXELS, pass->buffers[PIXELS]);
}

/* Draws what was listed with the program in use. */
static void draw_clusters(const struct mesh_pass *pass)
{
    for (size_t k = 0; k < pass->drawn_count; k += PORTION) {
        const size_t left = pass->drawn_count - k;
        glMultiDrawElements(GL_TRIANGLES, pass->counts + k, GL_UNSIGNED_INT, pass->offsets + k,
                            (GLsizei)(left < PORTION ? left : PORTION));
        glFlush();
    }
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

/* Draws `some` ranges of each query, behind `first` of them that were drawn, and reads their pixels. Returns in
 * `is_last` whether those are all. */
static conus_status draw_queries(bool *is_last, struct mesh_pass *pass, const struct mesh_query *queries, size_t count,
                                 size_t first, size_t some)
{
    upload_pixels(pass, queries, count);
    bind_all(pass);
    *is_last = true;
    for (size_t i = 0; i < count; i++) {
        const size_t begin = (i ? pass->ends[i - 1] : 0) + first;
        const size_t end = begin + some < pass->ends[i] ? begin + some : pass->ends[i];
        list_clusters(pass, &queries[i].view, queries[i].pixels.distances, begin, end);
        set_first(pass, &queries[i].view, (GLint)(i * pixel_count(pass)));
        draw_clusters(pass);
        *is_last = *is_last && end >= pass->ends[i];
    }
    struct readback_part part = {pass->buffers[PIXELS], pixels_size(pass, count), NULL};
    conus_status status = readback_wait(&pass->readback, &part, 1, "mesh ID pass");
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

/* Draws queries until all their ranges are drawn: 1 of each, then the next 2, 4, 8 and so on, so that those behind are
 * left out by what is known by then. Where a pixel has too little room, it grows, and there are no pixels any more. */
static conus_status render_together(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    bool is_last = false;
    conus_status status = list_shown(pass, queries, count);
    for (size_t first = 0, some = 1; !is_last && !status; first += some, some *= 2) {
        status = draw_queries(&is_last, pass, queries, count, first, some);
        const uint32_t most = status ? 0 : settle_queries(pass, queries, count);
        if (most > pass->capacity) {
            pass->pixel_slots = 0;
            return create_program(pass, FIRST, (most + 2 + CAPACITY_STEP - 1) / CAPACITY_STEP * CAPACITY_STEP - 2);
        }
    }
    return status;
}

conus_status mesh_pass_render(struct mesh_pass *pass, const struct mesh_query *queries, size_t count)
{
    conus_status status = count ? set_resolution(pass, queries->view.resolution) : CONUS_OK;
    for (size_t first = 0, together; first < count && !status; first += pass->pixel_slots ? together : 0) {
        status = pass->pixel_slots < count - first ? make_pixels(pass, count - first) : CONUS_OK;
        together = pass->pixel_slots < count - first ? pass->pixel_slots : count - first;
        status = status ? status : render_together(pass, queries + first, together);
    }
    return status;
}

/* Draws what was listed until all hits are taken. */
static conus_status take_hits(struct mesh_pass *pass, const struct mesh_view *view, mesh_pass_take take, void *user)
{
    struct shader_list *list = &pass->hits;
    conus_status status = CONUS_OK;
    shader_list_begin(list, view->resolution * view->resolution, pass->triangles);
    while (!status && shader_list_next(list, HITS)) {
        const void *records = NULL;
        uint32_t count = 0;
        glUseProgram(pass->programs[ALL]);
        glUniform2i(DRAWN_PIXELS, (GLint)list->first, (GLint)list->end);
        draw_clusters(pass);
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
    status = status ? status : list_shown(pass, &query, 1);
    if (status) {
        return status;
    }
    bind_all(pass);
    set_view(pass->programs[ALL], view);
    for (size_t k = 0; k < pass->ends[0] && !status; k += BATCH) {
        list_clusters(pass, view, NULL, k, k + BATCH < pass->ends[0] ? k + BATCH : pass->ends[0]);
        status = take_hits(pass, view, take, user);
    }
    return status;
}
