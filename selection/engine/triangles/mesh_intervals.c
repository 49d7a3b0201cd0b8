/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs crossings of surfaces: sorts them per ray and object, and makes intervals of them. */
#include "selection/engine/triangles/mesh_rays.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far single precision and a fragment's rounding may move a crossing, as a part of the largest coordinate. */
#define SLACK 1e-5

enum { FIRST_CAPACITY = 4096, FEW = 64 };

/* The exit of an interval that has not ended yet. */
#define OPEN (-1.0)

/* The crossings of one ray with one object, in order. */
struct chain {
    struct crossing *crossings;
    size_t count;
    const struct mesh *mesh;
    double slack;
    const struct cone *cone;
    struct layers *out;
    size_t first; /* of its intervals in `out` */
};

void mesh_intervals_init(struct mesh_intervals *out, const conus_atlas *atlas)
{
    double reach = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        for (int a = 0; a < 3 && mesh; a++) {
            reach = fmax(reach, fmax(fabs(mesh->shape.low[a]), fabs(mesh->shape.high[a])));
        }
    }
    *out = (struct mesh_intervals){.atlas = atlas, .slack = SLACK * reach};
}

void mesh_intervals_finish(struct mesh_intervals *intervals)
{
    memory_free(intervals->crossings);
    memory_free(intervals->sorted);
    memory_free(intervals->end);
    *intervals = (struct mesh_intervals){0};
}

conus_status mesh_intervals_grow(struct mesh_intervals *intervals)
{
    size_t capacity = intervals->capacity ? 2 * intervals->capacity : FIRST_CAPACITY;
    struct crossing *crossings = memory_resize(intervals->crossings, capacity, sizeof *crossings);
    if (!crossings) {
        return CONUS_ERROR_MEMORY;
    }
    intervals->crossings = crossings;
    intervals->capacity = capacity;
    return CONUS_OK;
}

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
        order_sort(crossings, count, sizeof *crossings, compare);
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

static conus_status reserve(struct mesh_intervals *intervals, size_t pixels)
{
    if (intervals->sorted_capacity < intervals->capacity) {
        struct crossing *sorted = memory_raw(intervals->capacity, sizeof *sorted);
        if (!sorted) {
            return CONUS_ERROR_MEMORY;
        }
        memory_free(intervals->sorted);
        intervals->sorted = sorted;
        intervals->sorted_capacity = intervals->capacity;
    }
    if (intervals->pixel_capacity < pixels) {
        size_t *end = memory_raw(pixels, sizeof *end);
        if (!end) {
            return CONUS_ERROR_MEMORY;
        }
        memory_free(intervals->end);
        intervals->end = end;
        intervals->pixel_capacity = pixels;
    }
    return CONUS_OK;
}

static const float *corner_of(const struct mesh *mesh, uint32_t triangle, int k)
{
    return &mesh->positions[3 * (size_t)mesh->triangles[3 * (size_t)triangle + (size_t)k]];
}

/* Whether two triangles have a corner in common: one at the same place. */
static bool are_neighbours(const struct mesh *mesh, uint32_t a, uint32_t b)
{
    for (int k = 0; k < 9; k++) {
        const float *p = corner_of(mesh, a, k / 3);
        const float *q = corner_of(mesh, b, k % 3);
        if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
            return true;
        }
    }
    return false;
}

static bool passes(const struct chain *chain, uint32_t triangle)
{
    uint32_t pixel = chain->crossings[0].pixel;
    uint32_t n = chain->cone->resolution;
    double origin[3];
    double direction[3];
    cone_origin(origin, chain->cone, pixel % n, pixel / n);
    cone_ray(direction, chain->cone, pixel % n, pixel / n);
    return mesh_is_passed(chain->mesh, triangle, origin, direction);
}

/* Whether two crossings may be the same point of the surface: at an edge or corner that both have. */
static bool are_one(const struct chain *chain, const struct crossing *a, const struct crossing *b)
{
    return fabs(b->t - a->t) <= chain->slack && are_neighbours(chain->mesh, a->triangle, b->triangle);
}

/* From which crossing on those of crossing `at` may be found, all near to it. */
static size_t first_near(const struct chain *chain, size_t at)
{
    size_t first = at;
    while (first > 0 && chain->crossings[at].t - chain->crossings[first - 1].t <= chain->slack) {
        first--;
    }
    return first;
}

/* A ray at an edge or corner may be found in all its triangles, but goes through the surface only in those that it
 * passes, or once where it is found in others alone: all but these are repeated. */
static bool is_repeated(const struct chain *chain, size_t at)
{
    const struct crossing *crossing = &chain->crossings[at];
    bool other = false;
    for (size_t i = first_near(chain, at); i < chain->count && !other; i++) {
        const struct crossing *near = &chain->crossings[i];
        if (near->t - crossing->t > chain->slack) {
            break;
        }
        other = i != at && near->side == crossing->side && are_one(chain, crossing, near) &&
                (i < at || passes(chain, near->triangle));
    }
    return other && !passes(chain, crossing->triangle);
}

/* Where the point of the surface that a crossing is was found first. */
static const struct crossing *first_found(const struct chain *chain, size_t at)
{
    const struct crossing *crossing = &chain->crossings[at];
    for (size_t i = first_near(chain, at); i < at; i++) {
        const struct crossing *earlier = &chain->crossings[i];
        if (earlier->side == crossing->side && are_one(chain, earlier, crossing) && !passes(chain, earlier->triangle)) {
            return earlier;
        }
    }
    return crossing;
}

static conus_status add_interval(struct chain *chain, const struct crossing *at, double entry, double exit)
{
    return layers_add(chain->out, &(conus_interval){at->pixel, at->object, entry, exit, at->triangle});
}

static bool begins_in_bounds(const struct chain *chain)
{
    const struct mesh_shape *shape = &chain->mesh->shape;
    uint32_t pixel = chain->crossings[0].pixel;
    double origin[3];
    bool inside = true;
    cone_origin(origin, chain->cone, pixel % chain->cone->resolution, pixel / chain->cone->resolution);
    for (int a = 0; a < 3; a++) {
        inside = inside && origin[a] >= shape->low[a] && origin[a] <= shape->high[a];
    }
    return inside;
}

/* How often a closed surface winds around where the ray begins: as often as ways out lie ahead, less ways in. */
static int winding_at_start(const struct chain *chain)
{
    int winding = 0;
    for (size_t i = 0; i < chain->count; i++) {
        winding -= is_repeated(chain, i) ? 0 : chain->crossings[i].side;
    }
    return winding;
}

/* Intervals are where a closed surface winds around the ray's points. */
static conus_status find_inside(struct chain *chain, int winding)
{
    conus_status status = winding ? add_interval(chain, &chain->crossings[0], 0, OPEN) : CONUS_OK;
    for (size_t i = 0; i < chain->count && !status; i++) {
        const struct crossing *crossing = &chain->crossings[i];
        int next = is_repeated(chain, i) ? winding : winding + crossing->side;
        if (winding == 0 && (next != 0 || crossing->side == 0)) {
            const struct crossing *first = first_found(chain, i);
            status = add_interval(chain, first, first->t, next ? OPEN : first->t);
        } else if (winding != 0 && next == 0) {
            chain->out->intervals[chain->out->count - 1].exit = crossing->t;
        }
        winding = next;
    }
    return status;
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

/* The last interval that has no exit yet; NULL = none. */
static conus_interval *last_open(const struct chain *chain)
{
    for (size_t i = chain->out->count; i > chain->first; i--) {
        if (chain->out->intervals[i - 1].exit == OPEN) {
            return &chain->out->intervals[i - 1];
        }
    }
    return NULL;
}

/* Brackets: an exit ends the last interval that is open, with all that lies in it. */
static conus_status leave_object(struct chain *chain, size_t index)
{
    const struct crossing *at = &chain->crossings[index];
    conus_interval *open = last_open(chain);
    if (open) {
        open->exit = at->t;
        chain->out->count = (size_t)(open - chain->out->intervals) + 1;
        return CONUS_OK;
    }
    return add_interval(chain, at, at->t, turn_graze(chain, index) ? OPEN : at->t);
}

static conus_status find_brackets(struct chain *chain)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < chain->count && !status; i++) {
        const struct crossing *crossing = &chain->crossings[i];
        int direction = direction_of(chain, crossing);
        if (is_repeated(chain, i)) {
            continue;
        }
        status = direction < 0 ? leave_object(chain, i)
                               : add_interval(chain, crossing, crossing->t, direction ? OPEN : crossing->t);
    }
    return status;
}

/* Drops intervals that never ended, and joins those that meet. */
static void tidy(struct chain *chain)
{
    conus_interval *intervals = chain->out->intervals + chain->first;
    size_t count = chain->out->count - chain->first;
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        conus_interval interval = intervals[i];
        interval.exit = interval.exit == OPEN ? interval.entry : interval.exit;
        if (kept && interval.entry <= intervals[kept - 1].exit) {
            intervals[kept - 1].exit = fmax(intervals[kept - 1].exit, interval.exit);
        } else {
            intervals[kept++] = interval;
        }
    }
    chain->out->count = chain->first + kept;
}

/* A closed surface around an apex that is out of its bounds: something was missed, and brackets do what they can. */
static conus_status pair_chain(struct chain *chain)
{
    chain->first = chain->out->count;
    bool closed = chain->mesh->shape.closed;
    int winding = closed ? winding_at_start(chain) : 0;
    closed = closed && (winding == 0 || begins_in_bounds(chain));
    conus_status status = closed ? find_inside(chain, winding) : find_brackets(chain);
    tidy(chain);
    return status;
}

static conus_status pair_pixel(struct layers *out, const struct mesh_intervals *intervals, const struct cone *cone,
                               struct crossing *crossings, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0, next = 0; i < count && !status; i = next) {
        uint32_t object = crossings[i].object;
        while (next < count && crossings[next].object == object) {
            next++;
        }
        struct chain chain = {.crossings = crossings + i, .count = next - i, .slack = intervals->slack, .cone = cone};
        chain.mesh = atlas_object_mesh(intervals->atlas, object);
        chain.out = out;
        status = pair_chain(&chain);
    }
    return status;
}

conus_status mesh_intervals_pair(struct layers *out, struct mesh_intervals *intervals, const struct cone *cone)
{
    size_t pixels = (size_t)cone->resolution * cone->resolution;
    conus_status status = reserve(intervals, pixels);
    if (!status) {
        /* Moves the crossings to `sorted`, pixel by pixel; end[p] becomes one past the last of pixel p. */
        size_t *end = intervals->end;
        size_t total = 0;
        memset(end, 0, pixels * sizeof *end);
        for (size_t i = 0; i < intervals->count; i++) {
            end[intervals->crossings[i].pixel]++;
        }
        for (size_t p = 0; p < pixels; p++) {
            size_t first = total;
            total += end[p];
            end[p] = first;
        }
        for (size_t i = 0; i < intervals->count; i++) {
            intervals->sorted[end[intervals->crossings[i].pixel]++] = intervals->crossings[i];
        }
    }
    for (size_t p = 0, first = 0; p < pixels && !status; first = intervals->end[p++]) {
        sort_pixel(intervals->sorted + first, intervals->end[p] - first);
        status = pair_pixel(out, intervals, cone, intervals->sorted + first, intervals->end[p] - first);
    }
    intervals->count = 0;
    return status;
}
