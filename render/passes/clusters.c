/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts meshes into clusters of neighbouring triangles and finds a bounding ball of each. */
#include "render/passes/id_pass.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <assert.h>

#define NO_VERTEX UINT32_MAX

/* Three times the middle of a triangle, and its number. */
struct middle {
    float at[3];
    uint32_t triangle;
};

/* Scratch space: of the largest mesh, and the order of meshes. */
struct scratch {
    struct middle *order; /* `triangle` is the mesh's place */
    struct middle *middles;
    uint32_t *vertex_of; /* a mesh's vertex -> one of its numbers when drawn */
};

static int longest_axis(const struct middle *middles, size_t count)
{
    float low[3] = {INFINITY, INFINITY, INFINITY};
    float high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fminf(low[a], middles[i].at[a]);
            high[a] = fmaxf(high[a], middles[i].at[a]);
        }
    }
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        axis = high[a] - low[a] > high[axis] - low[axis] ? a : axis;
    }
    return axis;
}

/* Hoare's selection: afterwards the `part` lowest along the axis come first. */
static void select_lowest(struct middle *middles, size_t count, size_t part, int axis)
{
    size_t low = 0;
    size_t high = count - 1;
    while (low < high) {
        float pivot = middles[low + (high - low) / 2].at[axis];
        size_t i = low;
        size_t j = high;
        while (true) {
            while (middles[i].at[axis] < pivot) {
                i++;
            }
            while (middles[j].at[axis] > pivot) {
                j--;
            }
            if (i >= j) {
                break;
            }
            struct middle *a = &middles[i++];
            struct middle *b = &middles[j--];
            struct middle held = *a;
            *a = *b;
            *b = held;
        }
        if (part <= j) {
            high = j;
        } else {
            low = j + 1;
        }
    }
}

/* Orders the triangles so that each CLUSTER_TRIANGLES in a row are neighbours. */
static void gather_neighbours(struct middle *middles, size_t count)
{
    while (count > CLUSTER_TRIANGLES) {
        size_t parts = (count + CLUSTER_TRIANGLES - 1) / CLUSTER_TRIANGLES;
        size_t half = parts / 2 * CLUSTER_TRIANGLES;
        select_lowest(middles, count, half, longest_axis(middles, count));
        gather_neighbours(middles, half);
        middles += half;
        count -= half;
    }
}

static const float *corner_position(const struct clusters *clusters, size_t corner)
{
    return &clusters->positions[3 * (size_t)clusters->corners[corner]];
}

/* A ball around the middle of the bounds of the triangles drawn as first, first + 1, ...: centre and radius. */
static void find_ball(float ball[4], const struct clusters *clusters, size_t first, size_t count)
{
    float low[3] = {INFINITY, INFINITY, INFINITY};
    float high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t k = 3 * first; k < 3 * (first + count); k++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fminf(low[a], corner_position(clusters, k)[a]);
            high[a] = fmaxf(high[a], corner_position(clusters, k)[a]);
        }
    }
    double farthest = 0;
    for (int a = 0; a < 3; a++) {
        ball[a] = low[a] / 2 + high[a] / 2;
    }
    for (size_t k = 3 * first; k < 3 * (first + count); k++) {
        double offset[3];
        for (int a = 0; a < 3; a++) {
            offset[a] = (double)corner_position(clusters, k)[a] - (double)ball[a];
        }
        farthest = fmax(farthest, vec3_dot(offset, offset));
    }
    ball[3] = nextafterf((float)(sqrt(farthest) * (1 + 1e-12)), INFINITY);
}

static uint32_t new_vertex(struct clusters *clusters, const struct mesh *mesh, uint32_t vertex, size_t number)
{
    for (size_t a = 0; a < 3; a++) {
        clusters->positions[3 * number + a] = mesh->positions[3 * (size_t)vertex + a];
    }
    return (uint32_t)number;
}

/* Lays out a mesh from triangle number `first` on. Vertices in excess of one per triangle go behind them all. */
static void lay_out(struct clusters *clusters, const struct mesh *mesh, const struct scratch *scratch, size_t first)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        scratch->vertex_of[v] = NO_VERTEX;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        uint32_t triangle = scratch->middles[i].triangle;
        const uint32_t *corner = &mesh->triangles[3 * (size_t)triangle];
        size_t last = 0; /* the corner that becomes the last: one whose vertex is not drawn yet, if there is one */
        while (last < 2 && scratch->vertex_of[corner[last]] != NO_VERTEX) {
            last++;
        }
        clusters->triangle[first + i] = triangle;
        for (size_t k = 0; k < 3; k++) { /* still the mesh's vertices; turned, not mirrored */
            clusters->corners[3 * (first + i) + k] = corner[(last + 1 + k) % 3];
        }
        scratch->vertex_of[corner[last]] = new_vertex(clusters, mesh, corner[last], first + i);
    }
    for (size_t i = first; i < first + mesh->triangle_count; i++) {
        uint32_t *corner = &clusters->corners[3 * i];
        for (size_t k = 0; k < 2; k++) {
            uint32_t *number = &scratch->vertex_of[corner[k]];
            *number = *number == NO_VERTEX ? new_vertex(clusters, mesh, corner[k], clusters->vertex_count++) : *number;
            corner[k] = *number;
        }
        corner[2] = (uint32_t)i;
    }
}

static void add_clusters(struct clusters *clusters, uint32_t object, size_t first, size_t count)
{
    for (size_t at = 0; at < count; at += CLUSTER_TRIANGLES) {
        struct cluster *cluster = &clusters->cluster[clusters->cluster_count];
        cluster->first = (uint32_t)(first + at);
        cluster->count = (uint32_t)(count - at < CLUSTER_TRIANGLES ? count - at : CLUSTER_TRIANGLES);
        cluster->object = object;
        find_ball(&clusters->balls[4 * clusters->cluster_count++], clusters, cluster->first, cluster->count);
    }
}

/* A ball around each `step` clusters in a row. */
static void find_balls(float *balls, const struct clusters *clusters, size_t step)
{
    for (size_t at = 0; at < clusters->cluster_count; at += step, balls += 4) {
        const size_t first = clusters->cluster[at].first;
        const bool is_last = clusters->cluster_count - at <= step;
        const size_t end = is_last ? clusters->triangle_count : clusters->cluster[at + step].first;
        find_ball(balls, clusters, first, end - first);
    }
}

static conus_status reserve_clusters(struct clusters *clusters, struct scratch *scratch,
                                     const struct mesh *const *meshes, size_t count)
{
    size_t cluster_count = 0, triangles = 0, vertices = 0;
    size_t most_triangles = 0, most_vertices = 0; /* of one mesh */
    for (size_t i = 0; i < count; i++) {
        const struct mesh *mesh = meshes[i];
        if (mesh) {
            cluster_count += (mesh->triangle_count + CLUSTER_TRIANGLES - 1) / CLUSTER_TRIANGLES;
            triangles += mesh->triangle_count;
            vertices += mesh->triangle_count + mesh->vertex_count; /* at most */
            most_triangles = mesh->triangle_count > most_triangles ? mesh->triangle_count : most_triangles;
            most_vertices = mesh->vertex_count > most_vertices ? mesh->vertex_count : most_vertices;
        }
    }
    if (vertices > INT32_MAX) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%zu triangles: the gl engine takes up to 1e9", triangles);
    }
    clusters->vertex_count = triangles; /* the last corners; more come with lay_out() */
    clusters->cluster = memory_raw(cluster_count, sizeof *clusters->cluster);
    clusters->group_count = (cluster_count + CLUSTER_GROUP - 1) / CLUSTER_GROUP;
    clusters->range_count = (cluster_count + CLUSTER_RANGE - 1) / CLUSTER_RANGE;
    clusters->balls = memory_raw(cluster_count + clusters->group_count, 4 * sizeof *clusters->balls);
    clusters->range_balls = memory_raw(clusters->range_count, 4 * sizeof *clusters->range_balls);
    clusters->triangle = memory_raw(triangles, sizeof *clusters->triangle);
    clusters->positions = memory_raw(vertices, 3 * sizeof *clusters->positions);
    clusters->corners = memory_raw(triangles, 3 * sizeof *clusters->corners);
    scratch->order = memory_raw(count, sizeof *scratch->order);
    scratch->middles = memory_raw(most_triangles, sizeof *scratch->middles);
    scratch->vertex_of = memory_raw(most_vertices, sizeof *scratch->vertex_of);
    return clusters->cluster && clusters->balls && clusters->range_balls && clusters->triangle && clusters->positions &&
                   clusters->corners && scratch->order && scratch->middles && scratch->vertex_of
               ? CONUS_OK
               : CONUS_ERROR_MEMORY;
}

/* Lists the meshes, neighbours together. Returns how many there are. */
static size_t order_meshes(struct middle *order, const struct mesh *const *meshes, size_t count)
{
    size_t listed = 0;
    for (size_t i = 0; i < count; i++) {
        if (meshes[i] && meshes[i]->triangle_count) {
            const float *first = &meshes[i]->positions[3 * (size_t)meshes[i]->triangles[0]];
            order[listed++] = (struct middle){{first[0], first[1], first[2]}, (uint32_t)i};
        }
    }
    gather_neighbours(order, listed);
    return listed;
}

/* Adds a mesh behind those that there are. */
static void add_mesh(struct clusters *clusters, const struct scratch *scratch, const struct mesh *mesh, uint32_t object)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = &mesh->triangles[3 * t];
        scratch->middles[t].triangle = (uint32_t)t;
        for (size_t a = 0; a < 3; a++) {
            scratch->middles[t].at[a] = mesh->positions[3 * (size_t)corners[0] + a] +
                                        mesh->positions[3 * (size_t)corners[1] + a] +
                                        mesh->positions[3 * (size_t)corners[2] + a];
        }
    }
    gather_neighbours(scratch->middles, mesh->triangle_count);
    lay_out(clusters, mesh, scratch, clusters->triangle_count);
    add_clusters(clusters, object, clusters->triangle_count, mesh->triangle_count);
    clusters->triangle_count += mesh->triangle_count;
}

conus_status clusters_init(struct clusters *out, const struct mesh *const *meshes, size_t count)
{
    struct clusters clusters = {0};
    struct scratch scratch = {0};
    conus_status status = reserve_clusters(&clusters, &scratch, meshes, count);
    const size_t listed = status ? 0 : order_meshes(scratch.order, meshes, count);
    for (size_t i = 0; i < listed; i++) {
        const uint32_t place = scratch.order[i].triangle;
        add_mesh(&clusters, &scratch, meshes[place], place + 1);
    }
    memory_free(scratch.order);
    memory_free(scratch.middles);
    memory_free(scratch.vertex_of);
    if (status) {
        clusters_finish(&clusters);
        return status;
    }
    find_balls(clusters.balls + 4 * clusters.cluster_count, &clusters, CLUSTER_GROUP);
    find_balls(clusters.range_balls, &clusters, CLUSTER_RANGE);
    *out = clusters;
    return CONUS_OK;
}

void clusters_finish(struct clusters *clusters)
{
    memory_free(clusters->cluster);
    memory_free(clusters->balls);
    memory_free(clusters->range_balls);
    memory_free(clusters->triangle);
    clusters_drop_triangles(clusters);
    *clusters = (struct clusters){0};
}

void clusters_drop_triangles(struct clusters *clusters)
{
    memory_free(clusters->positions);
    memory_free(clusters->corners);
    clusters->positions = NULL;
    clusters->corners = NULL;
}

const struct cluster *clusters_find(const struct clusters *clusters, uint32_t triangle)
{
    size_t end = clusters->cluster_count;
    size_t low = triangle / CLUSTER_TRIANGLES; /* not beyond it, and seldom far before it */
    size_t step = 1;
    assert(triangle < clusters->triangle_count);
    for (; end - low > step && clusters->cluster[low + step].first <= triangle; step *= 2) {
        low += step;
    }
    size_t high = end - low > step ? low + step : end;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (clusters->cluster[middle].first <= triangle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return &clusters->cluster[low];
}
