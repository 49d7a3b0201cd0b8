/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The walk of traverse_one() for LANES rays at a time: the body of one instruction set's kernel. A kernel's source
 * defines LANES and KERNEL (the function's name), includes this once, and is compiled with that set's flags.
 *
 * Every lane computes what traverse_one() does, with the same expressions. It only saves the comparisons that find the
 * cell after a leap: position o + t d differs from the exact crossings by less than NEAR cells (origins are below
 * TRAVERSE_FAR), so rounding it gives the cell unless a face is nearer than that. Such lanes, and those that leave the
 * grid at the very time of the leap, are handed to the scalar functions. */
#include "selection/traverse.h"

#include <math.h>
#include <string.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define NEAR 1e-6
#define INLINE inline __attribute__((always_inline))

typedef double reals __attribute__((vector_size(LANES * 8), aligned(8)));
typedef int64_t masks __attribute__((vector_size(LANES * 8), aligned(8)));

/* A ray per lane. */
struct lanes {
    reals origin[3], direction[3], inverse[3], sign[3];
    reals stop; /* when the ray leaves the grid, or its limit */
};

/* Where each lane is: in its cell since t. */
struct places {
    reals cell[3], t;
    masks live;
};

static INLINE reals all(double x)
{
    return x - (reals){0};
}

static INLINE reals choose(masks mask, reals yes, reals no)
{
    return (reals)(((masks)yes & mask) | ((masks)no & ~mask));
}

static INLINE reals smaller(reals a, reals b)
{
    return choose(a < b, a, b);
}

static INLINE bool any(masks mask)
{
    int64_t bits = 0;
    for (int l = 0; l < LANES; l++) {
        bits |= mask[l];
    }
    return bits != 0;
}

/* To the nearest whole number, for |x| < 2^51. */
static INLINE reals nearest(reals x)
{
    reals big = all(0x1.8p52);
    return (x + big) - big;
}

/* The codes of the lanes' cells, which are in the grid. */
static INLINE reals codes_at(const struct leap_map *map, const reals cell[3])
{
    double row = (double)map->bricks[0] * LEAP_BRICK_VOXELS;
    double layer = row * (double)map->bricks[1];
    const double within[3] = {1, LEAP_BRICK, LEAP_BRICK * LEAP_BRICK};
    const double between[3] = {LEAP_BRICK_VOXELS, row, layer};
    reals at = all(0x1p52); /* whole numbers from here on are in the low bits */
    for (int a = 0; a < 3; a++) {
        reals brick = nearest((cell[a] - 3.5) * 0.125);
        at += cell[a] * within[a] + brick * (between[a] - LEAP_BRICK * within[a]);
    }
    masks index = (masks)at & (((int64_t)1 << 52) - 1);
    reals codes;
    for (int l = 0; l < LANES; l++) {
        codes[l] = map->codes[index[l]];
    }
    return codes;
}

static INLINE reals exit_times(const struct lanes *rays, int a, reals cell)
{
    return ((cell + rays->sign[a] * 0.5) - rays->origin[a]) * rays->inverse[a];
}

static void extract(struct traverse_ray *out, const struct lanes *rays, int lane)
{
    for (int a = 0; a < 3; a++) {
        out->origin[a] = rays->origin[a][lane];
        out->direction[a] = rays->direction[a][lane];
        out->inverse[a] = rays->inverse[a][lane];
        out->sign[a] = rays->sign[a][lane];
    }
}

static void place(struct places *places, int lane, const struct traverse_place *place, bool inside)
{
    for (int a = 0; a < 3; a++) {
        places->cell[a][lane] = place->cell[a];
    }
    places->t[lane] = place->t;
    places->live[lane] = inside && place->t < INFINITY ? -1 : 0;
}

static __attribute__((noinline)) void enter_carefully(const struct leap_map *map, const struct lanes *rays,
                                                      struct places *places, masks which)
{
    for (int l = 0; l < LANES; l++) {
        if (which[l]) {
            struct traverse_ray ray;
            struct traverse_place start;
            extract(&ray, rays, l);
            bool inside = traverse_enter(map, &ray, &start);
            place(places, l, &start, inside);
        }
    }
}

static __attribute__((noinline)) void leap_carefully(const struct leap_map *map, const struct lanes *rays,
                                                     const struct places *from, reals radius, struct places *to,
                                                     masks which)
{
    for (int l = 0; l < LANES; l++) {
        if (which[l]) {
            struct traverse_ray ray;
            struct traverse_place here = {.cell = {from->cell[0][l], from->cell[1][l], from->cell[2][l]}};
            extract(&ray, rays, l);
            bool inside = traverse_leap(map, &ray, radius[l], &here);
            place(to, l, &here, inside);
        }
    }
}

static void load(struct lanes *out, const struct leap_map *map, const struct traverse_bundle *bundle, size_t first)
{
    memcpy(&out->stop, bundle->limit + first, sizeof out->stop);
    for (int a = 0; a < 3; a++) {
        reals direction;
        memcpy(&direction, bundle->direction[a] + first, sizeof direction);
        reals inverse = 1 / direction;
        masks moves = (inverse < INFINITY) & (inverse > -INFINITY);
        out->origin[a] = choose(moves, all(bundle->origin[a]), all(traverse_cell(bundle->origin[a])));
        out->direction[a] = choose(moves, direction, all(0));
        out->inverse[a] = choose(moves, inverse, all(INFINITY));
        out->sign[a] = choose(moves & (direction < 0), all(-1), all(1));
        reals last = choose(out->sign[a] > 0, all((double)map->dim[a] - 1), all(0));
        out->stop = smaller(out->stop, exit_times(out, a, last));
    }
}

/* Cells at t; known[a] where axis a made the crossing. Returns the lanes that are too near to a face to tell. */
static INLINE masks find_cells(const struct lanes *rays, reals t, const masks crossed[3], const reals known[3],
                               reals cell[3])
{
    masks near = {0};
    for (int a = 0; a < 3; a++) {
        reals x = rays->origin[a] + t * rays->direction[a];
        reals guess = nearest(x);
        reals off = x - guess;
        near |= ~crossed[a] & ((off > 0.5 - NEAR) | (off < NEAR - 0.5));
        cell[a] = choose(crossed[a], known[a], guess);
    }
    return near;
}

static void enter(const struct leap_map *map, const struct lanes *rays, const struct traverse_bundle *bundle,
                  struct places *out)
{
    masks crossed[3] = {{0}};
    reals known[3];
    bool outside = false;
    out->t = all(0);
    out->live = (masks)(out->t == 0);
    for (int a = 0; a < 3; a++) {
        double start = traverse_cell(bundle->origin[a]);
        double end = (double)map->dim[a] - 1;
        known[a] = all(start);
        if (start < 0 || start > end) {
            double face = start < 0 ? 0 : end;
            known[a] = all(face);
            reals t = ((known[a] - rays->sign[a] * 0.5) - rays->origin[a]) * rays->inverse[a];
            out->live &= start < 0 ? rays->sign[a] > 0 : rays->sign[a] < 0;
            masks later = t >= out->t;
            out->t = choose(later, t, out->t);
            for (int b = 0; b < a; b++) {
                crossed[b] &= ~later;
            }
            crossed[a] = later;
            outside = true;
        }
    }
    out->live &= (out->t <= rays->stop) & (out->t < INFINITY);
    if (outside) {
        masks odd = find_cells(rays, out->t, crossed, known, out->cell) | (out->t == rays->stop);
        odd &= out->live;
        if (any(odd)) {
            enter_carefully(map, rays, out, odd);
        }
    } else {
        memcpy(out->cell, known, sizeof known);
    }
    for (int a = 0; a < 3; a++) { /* lanes that missed stay where there are codes */
        out->cell[a] = choose(out->live, out->cell[a], all(0));
    }
}

/* Lanes at cells with codes leave the empty box around them. */
static INLINE void leap(const struct leap_map *map, const struct lanes *rays, struct places *at, reals codes)
{
    struct places next;
    reals times[3], known[3];
    for (int a = 0; a < 3; a++) {
        reals reach = at->cell[a] + rays->sign[a] * (codes - 1);
        known[a] = reach + rays->sign[a];
        times[a] = exit_times(rays, a, reach);
    }
    masks crossed[3];
    crossed[0] = (times[0] <= times[1]) & (times[0] <= times[2]);
    crossed[1] = ~crossed[0] & (times[1] <= times[2]);
    crossed[2] = ~crossed[0] & ~crossed[1];
    next.t = smaller(smaller(times[0], times[1]), times[2]);
    next.live = at->live & (next.t <= rays->stop);
    masks odd = find_cells(rays, next.t, crossed, known, next.cell) | (next.t == rays->stop);
    odd &= next.live;
    if (any(odd)) {
        leap_carefully(map, rays, at, codes - 1, &next, odd);
    }
    for (int a = 0; a < 3; a++) {
        at->cell[a] = choose(next.live, next.cell[a], at->cell[a]);
    }
    at->t = choose(next.live, next.t, at->t);
    at->live = next.live;
}

static void store(const struct leap_map *map, struct traverse_bundle *bundle, size_t first, const struct places *at,
                  masks hit)
{
    for (int l = 0; l < LANES; l++) {
        size_t i = (size_t)at->cell[0][l];
        size_t j = (size_t)at->cell[1][l];
        size_t k = (size_t)at->cell[2][l];
        bundle->t[first + (size_t)l] = hit[l] ? at->t[l] : INFINITY;
        bundle->voxel[first + (size_t)l] = hit[l] ? i + map->dim[0] * (j + map->dim[1] * k) : UINT64_MAX;
    }
}

void KERNEL(const struct leap_map *map, struct traverse_bundle *bundle)
{
    for (size_t first = 0; first < bundle->count; first += LANES) {
        struct lanes rays;
        struct places at;
        masks hit = {0};
        load(&rays, map, bundle, first);
        enter(map, &rays, bundle, &at);
        while (any(at.live)) {
            reals codes = codes_at(map, at.cell);
            hit |= at.live & (codes == 0);
            at.live &= codes != 0;
            leap(map, &rays, &at, codes);
        }
        store(map, bundle, first, &at, hit);
    }
}
