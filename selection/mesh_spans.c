/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/mesh_spans.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the largest coordinate: what single precision may move a crossing by, and a fragment's rounding. */
#define SLACK 1e-5

enum { FIRST_CAPACITY = 4096, FEW = 64 };

/* The exit of a piece that has none yet. */
#define OPEN (-1.0)

/* The crossings of one ray with one object, in order. */
struct chain {
    struct crossing *crossings;
    size_t count;
    const struct mesh *mesh;
    double slack;
    const struct cone *cone;
    struct layers *out;
    size_t first; /* of its pieces in `out` */
};

void mesh_spans_init(struct mesh_spans *out, const conus_atlas *atlas)
{
    double reach = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        for (int a = 0; a < 3 && mesh; a++) {
            reach = fmax(reach, fmax(fabs(mesh->shape.low[a]), fabs(mesh->shape.high[a])));
        }
    }
    *out = (struct mesh_spans){.atlas = atlas, .slack = SLACK * reach};
}

void mesh_spans_finish(struct mesh_spans *spans)
{
    memory_free(spans->crossings);
    memory_free(spans->sorted);
    memory_free(spans->end);
    *spans = (struct mesh_spans){0};
}

conus_status mesh_spans_grow(struct mesh_spans *spans)
{
    size_t capacity = spans->capacity ? 2 * spans->capacity : FIRST_CAPACITY;
    struct crossing *crossings = memory_resize(spans->crossings, capacity, sizeof *crossings);
    if (!crossings) {
        return CONUS_ERROR_MEMORY;
    }
    spans->crossings = crossings;
    spans->capacity = capacity;
    return CONUS_OK;
}

/* ---- Order -------------------------------------------------------------------------------------------------- */

static bool is_before(const struct crossing *a, const struct crossing *b)
{
    if (a->object != b->object) {
        return a->object < b->object;
    }
    return a->t != b->t ? a->t < b->t : a->triangle < b->triangle;
}

static int compare(const void *a, const void *b)
{
    return is_before(a, b) ? -1 : is_before(b, a);
}

static void sort_pixel(struct crossing *crossings, size_t count)
{
    if (count > FEW) {
        qsort(crossings, count, sizeof *crossings, compare);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        struct crossing crossing = crossings[i];
        size_t place = i;
        for (; place > 0 && is_before(&crossing, &crossings[place - 1]); place--) {
            crossings[place] = crossings[place - 1];
        }
        crossings[place] = crossing;
    }
}

static conus_status make_room(struct mesh_spans *spans, size_t pixels)
{
    if (spans->sorted_capacity < spans->capacity) {
        struct crossing *sorted = memory_raw(spans->capacity, sizeof *sorted);
        if (!sorted) {
            return CONUS_ERROR_MEMORY;
        }
        memory_free(spans->sorted);
        spans->sorted = sorted;
        spans->sorted_capacity = spans->capacity;
    }
    if (spans->pixel_capacity < pixels) {
        size_t *end = memory_raw(pixels, sizeof *end);
        if (!end) {
            return CONUS_ERROR_MEMORY;
        }
        memory_free(spans->end);
        spans->end = end;
        spans->pixel_capacity = pixels;
    }
    return CONUS_OK;
}

/* Moves the crossings to `sorted`, pixel by pixel; end[p] becomes one past the last of pixel p. */
static void deal(struct mesh_spans *spans, size_t pixels)
{
    size_t *end = spans->end;
    size_t total = 0;
    memset(end, 0, pixels * sizeof *end);
    for (size_t i = 0; i < spans->count; i++) {
        end[spans->crossings[i].pixel]++;
    }
    for (size_t p = 0; p < pixels; p++) {
        size_t first = total;
        total += end[p];
        end[p] = first;
    }
    for (size_t i = 0; i < spans->count; i++) {
        spans->sorted[end[spans->crossings[i].pixel]++] = spans->crossings[i];
    }
}

/* ---- Pairs -------------------------------------------------------------------------------------------------- */

/* Whether two triangles have a corner in common. */
static bool are_neighbours(const struct mesh *mesh, uint32_t a, uint32_t b)
{
    const uint32_t *p = &mesh->triangles[3 * (size_t)a];
    const uint32_t *q = &mesh->triangles[3 * (size_t)b];
    for (int k = 0; k < 3; k++) {
        if (p[k] == q[0] || p[k] == q[1] || p[k] == q[2]) {
            return true;
        }
    }
    return false;
}

/* Whether b, behind a, may be the same point of the surface: at an edge or corner that both have. */
static bool are_one(const struct chain *chain, const struct crossing *a, const struct crossing *b)
{
    return b->t - a->t <= chain->slack && are_neighbours(chain->mesh, a->triangle, b->triangle);
}

/* A ray at an edge or corner goes through all its triangles, but through the surface once. */
static bool is_repeated(const struct chain *chain, size_t at)
{
    const struct crossing *crossing = &chain->crossings[at];
    for (size_t i = at; i > 0 && crossing->t - chain->crossings[i - 1].t <= chain->slack; i--) {
        const struct crossing *earlier = &chain->crossings[i - 1];
        if (earlier->side == crossing->side && are_one(chain, earlier, crossing)) {
            return true;
        }
    }
    return false;
}

/* 1 where the ray goes in, -1 where it comes out, 0 where it only touches. */
static int direction_of(const struct chain *chain, const struct crossing *crossing)
{
    return chain->mesh->shape.volume_mm3 < 0 ? -crossing->side : crossing->side;
}

/* A ray that grazes an edge goes in and comes out there. Where rounding has turned that around, it is put right; true
 * if so. */
static bool turn_graze(const struct chain *chain, size_t at)
{
    struct crossing *out = &chain->crossings[at];
    for (size_t i = at + 1; i < chain->count && chain->crossings[i].t - out->t <= chain->slack; i++) {
        struct crossing *in = &chain->crossings[i];
        if (in->side == -out->side && are_one(chain, out, in)) {
            out->side = -out->side;
            in->side = -in->side;
            return true;
        }
    }
    return false;
}

/* What a ray comes out of without having gone in surrounds the apex, if it is closed and reaches there. */
static bool begins_inside(const struct chain *chain)
{
    const struct mesh_shape *shape = &chain->mesh->shape;
    uint32_t pixel = chain->crossings[0].pixel;
    double origin[3];
    bool inside = shape->closed;
    cone_origin(origin, chain->cone, pixel % chain->cone->resolution, pixel / chain->cone->resolution);
    for (int a = 0; a < 3; a++) {
        inside = inside && origin[a] >= shape->low[a] && origin[a] <= shape->high[a];
    }
    return inside;
}

static conus_status add_piece(struct chain *chain, const struct crossing *at, double entry, double exit)
{
    return layers_add(chain->out, &(conus_span){at->pixel, at->object, entry, exit, at->triangle});
}

/* The last piece that has no exit yet; NULL = none. */
static conus_span *last_open(const struct chain *chain)
{
    for (size_t i = chain->out->count; i > chain->first; i--) {
        if (chain->out->spans[i - 1].exit == OPEN) {
            return &chain->out->spans[i - 1];
        }
    }
    return NULL;
}

static conus_status enter(struct chain *chain, const struct crossing *at)
{
    return add_piece(chain, at, at->t, OPEN);
}

/* Brackets: an exit ends the last piece that is open, with all that lies in it. */
static conus_status leave(struct chain *chain, size_t index)
{
    const struct crossing *at = &chain->crossings[index];
    conus_span *open = last_open(chain);
    if (open) {
        open->exit = at->t;
        chain->out->count = (size_t)(open - chain->out->spans) + 1;
        return CONUS_OK;
    }
    if (turn_graze(chain, index)) {
        return enter(chain, at);
    }
    if (begins_inside(chain)) {
        chain->out->count = chain->first;
        return add_piece(chain, &chain->crossings[0], 0, at->t);
    }
    return add_piece(chain, at, at->t, at->t);
}

/* Pieces that never ended have no length, and those that meet are one. */
static void tidy(struct chain *chain)
{
    conus_span *pieces = chain->out->spans + chain->first;
    size_t count = chain->out->count - chain->first;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        conus_span piece = pieces[i];
        piece.exit = piece.exit == OPEN ? piece.entry : piece.exit;
        if (kept && piece.entry <= pieces[kept - 1].exit) {
            pieces[kept - 1].exit = fmax(pieces[kept - 1].exit, piece.exit);
        } else {
            pieces[kept++] = piece;
        }
    }
    chain->out->count = chain->first + kept;
}

static conus_status pair_chain(struct chain *chain)
{
    conus_status status = CONUS_OK;
    chain->first = chain->out->count;
    for (size_t i = 0; i < chain->count && !status; i++) {
        const struct crossing *crossing = &chain->crossings[i];
        int direction = direction_of(chain, crossing);
        if (is_repeated(chain, i)) {
            continue;
        }
        if (direction > 0) {
            status = enter(chain, crossing);
        } else if (direction < 0) {
            status = leave(chain, i);
        } else {
            status = add_piece(chain, crossing, crossing->t, crossing->t);
        }
    }
    tidy(chain);
    return status;
}

static conus_status pair_pixel(struct layers *out, const struct mesh_spans *spans, const struct cone *cone,
                               struct crossing *crossings, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0, next = 0; i < count && !status; i = next) {
        uint32_t object = crossings[i].object;
        while (next < count && crossings[next].object == object) {
            next++;
        }
        struct chain chain = {.crossings = crossings + i, .count = next - i, .slack = spans->slack, .cone = cone};
        chain.mesh = atlas_object_mesh(spans->atlas, object);
        chain.out = out;
        status = pair_chain(&chain);
    }
    return status;
}

conus_status mesh_spans_pair(struct layers *out, struct mesh_spans *spans, const struct cone *cone)
{
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    conus_status status = make_room(spans, pixels);
    if (!status) {
        deal(spans, pixels);
    }
    for (size_t p = 0, first = 0; p < pixels && !status; first = spans->end[p++]) {
        sort_pixel(spans->sorted + first, spans->end[p] - first);
        status = pair_pixel(out, spans, cone, spans->sorted + first, spans->end[p] - first);
    }
    spans->count = 0;
    return status;
}
