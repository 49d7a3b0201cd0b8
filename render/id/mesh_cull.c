/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks meshes and clusters in the order of their distance, batch by batch. */
#include "render/id/mesh_cull.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Pixels by which a driver's vertex grid may move an edge, and a margin. */
#define MARGIN 0.02

/* Relative error of distances that comparisons allow for. */
#define ROUNDING 1e-9

enum { TILE_LIMIT = 16 }; /* tiles along a side of the buffer, at most */

/* An entry of the heap: a mesh, or a cluster of one. */
struct waiting {
    double nearest; /* mm: a lower bound of its distance from the apex; 0 where the order does not matter */
    uint32_t number;
    uint32_t is_mesh;
};

struct tiles {
    uint32_t low[2], high[2]; /* inclusive */
};

struct mesh_cull {
    const struct clusters *clusters;
    double apex[3], right[3], up[3], forward[3];
    double slope, cosine, sine; /* of half the angle; 0, 1 and 0 of a cylinder */
    double width;               /* half the buffer's edge at the apex: 0, or a cylinder's radius */
    uint32_t resolution;
    unsigned without;
    uint32_t tile_edge, tile_count;        /* pixels; tiles along an edge */
    double side[TILE_LIMIT];               /* of tiles of one pixel: slope of their outermost rays */
    double reach[TILE_LIMIT * TILE_LIMIT]; /* the farthest that any ray of the tile gets */
    double farthest;                       /* of them all */
    struct waiting *heap;                  /* a binary heap, nearest on top; [meshes + clusters] */
    size_t count;
    uint32_t *batch; /* [clusters] */
};

conus_status mesh_cull_create(struct mesh_cull **out, const struct clusters *clusters)
{
    struct mesh_cull *cull = memory_zeroed(1, sizeof *cull);
    if (!cull) {
        return CONUS_ERROR_MEMORY;
    }
    size_t cluster_count = clusters->first_cluster[clusters->mesh_count];
    cull->clusters = clusters;
    cull->heap = memory_raw(clusters->mesh_count + cluster_count, sizeof *cull->heap);
    cull->batch = memory_raw(cluster_count, sizeof *cull->batch);
    if (!cull->heap || !cull->batch) {
        mesh_cull_destroy(cull);
        return CONUS_ERROR_MEMORY;
    }
    *out = cull;
    return CONUS_OK;
}

void mesh_cull_destroy(struct mesh_cull *cull)
{
    if (cull) {
        memory_free(cull->heap);
        memory_free(cull->batch);
        memory_free(cull);
    }
}

size_t mesh_cull_size(const struct clusters *clusters)
{
    size_t cluster_count = clusters->first_cluster[clusters->mesh_count];
    return sizeof(struct mesh_cull) + (clusters->mesh_count + cluster_count) * sizeof(struct waiting) +
           cluster_count * sizeof(uint32_t);
}

static void sink(struct waiting *heap, size_t count, size_t at)
{
    struct waiting item = heap[at];
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        child += child + 1 < count && heap[child + 1].nearest < heap[child].nearest;
        if (!(heap[child].nearest < item.nearest)) {
            break;
        }
        heap[at] = heap[child];
    }
    heap[at] = item;
}

static void push_waiting(struct mesh_cull *cull, struct waiting item)
{
    size_t at = cull->count++;
    for (size_t parent; at > 0 && item.nearest < cull->heap[parent = (at - 1) / 2].nearest; at = parent) {
        cull->heap[at] = cull->heap[parent];
    }
    cull->heap[at] = item;
}

/* Faster than fmax() and fmin(), which are calls. NaN does not occur. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* A ball in the device's frame: to its right, up and forward. */
struct seen {
    double x, y, depth, radius;
};

static inline struct seen see(const struct mesh_cull *cull, double x, double y, double z, double radius)
{
    const double v[3] = {x - cull->apex[0], y - cull->apex[1], z - cull->apex[2]};
    return (struct seen){vec3_dot(v, cull->right), vec3_dot(v, cull->up), vec3_dot(v, cull->forward), radius};
}

static struct seen see_mesh(const struct mesh_cull *cull, size_t number)
{
    const double *const *ball = (const double *const *)cull->clusters->ball;
    return see(cull, ball[0][number], ball[1][number], ball[2][number], ball[3][number]);
}

static struct seen see_cluster(const struct mesh_cull *cull, size_t number)
{
    const struct cluster *cluster = &cull->clusters->cluster[number];
    return see(cull, cluster->centre[0], cluster->centre[1], cluster->centre[2], cluster->radius);
}

static inline bool is_in_pyramid(const struct mesh_cull *cull, const struct seen *ball)
{
    double sideways = larger(fabs(ball->x), fabs(ball->y));
    return (cull->without & MESH_CULL) ||
           (ball->depth > -ball->radius &&
            (sideways - cull->width) * cull->cosine - ball->depth * cull->sine < ball->radius);
}

static inline double nearest_of(const struct mesh_cull *cull, const struct seen *ball)
{
    double sideways =
        cull->width > 0 ? 0 : ball->x * ball->x + ball->y * ball->y; /* rays go to both sides, or only ahead */
    double distance = sqrt(sideways + ball->depth * ball->depth);
    return larger(distance - ball->radius - ROUNDING * (distance + ball->radius), 0);
}

/* The heap's key. */
static inline double key_of(const struct mesh_cull *cull, double nearest)
{
    return cull->without & MESH_ORDER ? 0 : nearest;
}

/* The pixels whose centres the ball may cover along one axis of the buffer; false if none. */
static bool find_pixels(uint32_t *first, uint32_t *last, const struct mesh_cull *cull, double offset,
                        const struct seen *ball)
{
    double near = cull->width + cull->slope * (ball->depth - ball->radius); /* half the buffer's edge there */
    double far = cull->width + cull->slope * (ball->depth + ball->radius);
    double low = offset - ball->radius;
    double high = offset + ball->radius;
    double n = cull->resolution;
    *first = 0;
    *last = cull->resolution - 1;
    if (near <= 0) {
        return true;
    }
    low = ((low / (low < 0 ? near : far) + 1) * n - 1) / 2 - MARGIN;
    high = ((high / (high > 0 ? near : far) + 1) * n - 1) / 2 + MARGIN;
    low = larger(ceil(low), 0);
    high = smaller(floor(high), n - 1);
    if (!(low <= high)) {
        return false;
    }
    *first = (uint32_t)low;
    *last = (uint32_t)high;
    return true;
}

static bool find_tiles(struct tiles *out, const struct mesh_cull *cull, const struct seen *ball)
{
    const double offset[2] = {ball->x, ball->y};
    for (int a = 0; a < 2; a++) {
        if (!find_pixels(&out->low[a], &out->high[a], cull, offset[a], ball)) {
            return false;
        }
        out->low[a] /= cull->tile_edge;
        out->high[a] /= cull->tile_edge;
    }
    return true;
}

/* Whether the ray of pixel (i, j) passes the ball, or so near that a driver may think so, and gets that far. */
static bool is_hit(const struct mesh_cull *cull, const struct seen *ball, uint32_t i, uint32_t j)
{
    double right = cull->side[i];
    double up = cull->side[j];
    double far = ball->depth + ball->radius;
    double pixel = 2 * (cull->width + cull->slope * far) / cull->resolution;
    double reach = ball->radius + 2 * MARGIN * pixel + ROUNDING * far;
    double square = 1, along = ball->depth;
    double off[3] = {ball->x - right, ball->y - up, 0};
    if (cull->width <= 0) { /* the cross product, in which nothing cancels, instead of a difference of squares */
        square += right * right + up * up;
        along += right * ball->x + up * ball->y;
        off[0] = ball->y - ball->depth * up;
        off[1] = ball->depth * right - ball->x;
        off[2] = up * ball->x - right * ball->y;
    }
    double inside = reach * reach - vec3_dot(off, off) / square;
    double known = cull->reach[j * cull->tile_count + i];
    return inside >= 0 && along / sqrt(square) - sqrt(inside) - ROUNDING * far <= known;
}

/* Whether any ray through the ball's tiles gets as far as the ball. */
static bool is_open(const struct mesh_cull *cull, const struct seen *ball, double nearest)
{
    struct tiles tiles;
    if (!find_tiles(&tiles, cull, ball)) {
        return cull->without & MESH_CULL;
    }
    bool is_whole =
        cull->tile_edge > 1 || ball->depth <= ball->radius || (cull->without & MESH_CULL); /* by tiles only */
    for (uint32_t j = tiles.low[1]; j <= tiles.high[1]; j++) {
        for (uint32_t i = tiles.low[0]; i <= tiles.high[0]; i++) {
            if (cull->reach[j * cull->tile_count + i] >= nearest && (is_whole || is_hit(cull, ball, i, j))) {
                return true;
            }
        }
    }
    return false;
}

void mesh_cull_begin(struct mesh_cull *cull, const struct mesh_view *view)
{
    const double *m = view->world_from_device;
    memcpy(cull->apex, m + 12, sizeof cull->apex);
    memcpy(cull->right, m, sizeof cull->right);
    memcpy(cull->up, m + 4, sizeof cull->up);
    vec3_scale(cull->forward, m + 8, -1);
    cull->slope = view->slope;
    cull->width = view->radius;
    cull->cosine = 1 / sqrt(1 + view->slope * view->slope);
    cull->sine = view->slope * cull->cosine;
    cull->resolution = view->resolution;
    cull->without = view->without;
    cull->tile_edge = (view->resolution + TILE_LIMIT - 1) / TILE_LIMIT;
    cull->tile_count = (view->resolution + cull->tile_edge - 1) / cull->tile_edge;
    for (uint32_t i = 0; i < cull->tile_count; i++) {
        double place = (2.0 * i + 1) / view->resolution - 1; /* Eq. 3 */
        cull->side[i] = place * (view->radius > 0 ? view->radius : view->slope);
    }
    cull->count = 0;
    for (size_t i = 0; i < cull->clusters->mesh_count; i++) {
        struct seen ball = see_mesh(cull, i);
        if (is_in_pyramid(cull, &ball)) {
            cull->heap[cull->count++] = (struct waiting){key_of(cull, nearest_of(cull, &ball)), (uint32_t)i, true};
        }
    }
    for (size_t i = cull->count / 2; i > 0; i--) {
        sink(cull->heap, cull->count, i - 1);
    }
}

void mesh_cull_hide(struct mesh_cull *cull, const double *distances)
{
    distances = cull->without & MESH_OCCLUSION ? NULL : distances;
    uint32_t n = cull->resolution;
    uint32_t tiles = cull->tile_count * cull->tile_count;
    for (uint32_t t = 0; t < tiles; t++) {
        cull->reach[t] = distances ? 0 : INFINITY;
    }
    for (uint32_t j = 0; j < n && distances; j++) {
        for (uint32_t i = 0; i < n; i++) {
            double *reach = &cull->reach[j / cull->tile_edge * cull->tile_count + i / cull->tile_edge];
            *reach = larger(*reach, distances[(size_t)j * n + i]);
        }
    }
    cull->farthest = 0;
    for (uint32_t t = 0; t < tiles; t++) {
        cull->farthest = larger(cull->farthest, cull->reach[t]);
    }
}

size_t mesh_cull_batch(const uint32_t **out, struct mesh_cull *cull, size_t triangles)
{
    const struct clusters *clusters = cull->clusters;
    size_t given = 0;
    size_t count = 0;
    while (cull->count && given < triangles) {
        struct waiting next = cull->heap[0];
        cull->heap[0] = cull->heap[--cull->count];
        sink(cull->heap, cull->count, 0);
        if (next.nearest > cull->farthest) {
            cull->count = 0;
            break;
        }
        struct seen seen = next.is_mesh ? see_mesh(cull, next.number) : see_cluster(cull, next.number);
        double nearest = cull->without & MESH_ORDER ? nearest_of(cull, &seen) : next.nearest; /* the heap may have 0 */
        if (!is_open(cull, &seen, nearest)) {
            continue;
        }
        if (!next.is_mesh) {
            cull->batch[count++] = next.number;
            given += clusters->cluster[next.number].count;
            continue;
        }
        const size_t *first = &clusters->first_cluster[next.number];
        for (size_t i = first[0]; i < first[1]; i++) {
            struct seen cluster = see_cluster(cull, i);
            double distance = nearest_of(cull, &cluster);
            if (is_in_pyramid(cull, &cluster) && is_open(cull, &cluster, distance)) {
                push_waiting(cull, (struct waiting){key_of(cull, distance), (uint32_t)i, false});
            }
        }
    }
    *out = cull->batch;
    return count;
}
