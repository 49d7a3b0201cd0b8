/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The walk of traverse_one() for LANES rays at a time: the body of one instruction set's kernel. A kernel's source
 * defines LANES and KERNEL (the function's name), includes this once, and is compiled with that set's flags.
 *
 * Every lane computes what traverse_one() does, with the same expressions. It only saves the comparisons that find the
 * cell after a leap: position o + t d differs from the exact crossings by less than NEAR cells (origins are below
 * TRAVERSE_FAR), so rounding it gives the cell unless a face is nearer than that. Such lanes, and those that leave the
 * grid at the very time of the leap, are handed to the scalar functions. */
#include "selection/lanes.h"
#include "selection/traverse.h"

#include <math.h>
#include <string.h>

/* How near to a face, in cells, a lane is handed to the scalar functions. */
#define NEAR 1e-6
#define EACH_AXIS _Pragma("GCC unroll 3")

/* A ray per lane. */
struct lanes {
    reals origin[3], direction[3], inverse[3], sign[3];
    reals stop; /* when the ray leaves the box, or its limit */
};

/* Where each lane is: in its cell since t. */
struct places {
    reals cell[3], t;
    truths live;
};

/* Down to a multiple of the brick's edge, for whole numbers from 0 to 2^50. */
static INLINE reals brick_start(reals cell)
{
    reals big = all(0x1.8p52 * LEAP_BRICK); /* where numbers are that far apart */
    return (cell - 0.5 * (LEAP_BRICK - 1) + big) - big;
}

/* Where leap_map_at() says, as a sum over the axes: cell * within + brick_start(cell) * beyond. */
struct layout {
    const uint8_t *codes;
    double within[3], beyond[3];
};

static void layout_init(struct layout *out, const struct leap_map *map)
{
    double within = 1;
    double between = LEAP_BRICK_VOXELS;
    out->codes = map->codes;
    for (int a = 0; a < 3; a++) {
        out->within[a] = within;
        out->beyond[a] = between / LEAP_BRICK - within;
        within *= LEAP_BRICK;
        between *= (double)map->bricks[a];
    }
}

/* The codes of the lanes' cells, which are in the grid. */
static INLINE reals codes_at(const struct layout *layout, const reals cell[3])
{
    reals at = all(0);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        at += cell[a] * layout->within[a] + brick_start(cell[a]) * layout->beyond[a];
    }
    return gather(layout->codes, at);
}

static INLINE reals exit_times(const struct lanes *rays, int a, reals cell)
{
    return ((cell + rays->sign[a] * 0.5) - rays->origin[a]) * rays->inverse[a];
}

static void extract(struct traverse_ray *out, const struct lanes *rays, int lane)
{
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        out->origin[a] = rays->origin[a][lane];
        out->direction[a] = rays->direction[a][lane];
        out->inverse[a] = rays->inverse[a][lane];
        out->sign[a] = rays->sign[a][lane];
    }
}

static void place(struct places *places, int lane, const struct traverse_place *place, bool inside)
{
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        places->cell[a][lane] = place->cell[a];
    }
    places->t[lane] = place->t;
    places->live = inside && place->t < INFINITY ? places->live : without(places->live, lane);
}

static __attribute__((noinline)) void enter_carefully(const struct leap_map *map, const struct lanes *rays,
                                                      struct places *places, truths which)
{
    for (int l = 0; l < LANES; l++) {
        if (is_true(which, l)) {
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
                                                     truths which)
{
    for (int l = 0; l < LANES; l++) {
        if (is_true(which, l)) {
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
    const double *m = bundle->index_from_world;
    reals world[3];
    memcpy(&out->stop, bundle->limit + first, sizeof out->stop);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        memcpy(&world[a], bundle->direction[a] + first, sizeof world[a]);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        reals direction = m[a] * world[0] + m[4 + a] * world[1] + m[8 + a] * world[2]; /* as mat4_direction() */
        reals inverse = 1 / direction;
        truths moves = less(magnitude(inverse), all(INFINITY));
        out->origin[a] = choose(moves, all(bundle->start[a]), all(bundle->start_cell[a]));
        out->direction[a] = choose(moves, direction, all(0));
        out->inverse[a] = choose(moves, inverse, all(INFINITY));
        out->sign[a] = choose(moves & less(direction, all(0)), all(-1), all(1));
        reals last = choose(less(all(0), out->sign[a]), all(map->last[a]), all(map->first[a]));
        out->stop = smaller(out->stop, exit_times(out, a, last));
    }
}

/* Cells at t; known[a] where axis a made the crossing. Returns the lanes that are too near to a face to tell. */
static INLINE truths find_cells(const struct lanes *rays, reals t, const truths crossed[3], const reals known[3],
                                reals cell[3])
{
    truths near = less(t, t); /* none */
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        reals x = rays->origin[a] + t * rays->direction[a];
        reals guess = nearest(x);
        near |= ~crossed[a] & less(all(0.5 - NEAR), magnitude(x - guess));
        cell[a] = choose(crossed[a], known[a], guess);
    }
    return near;
}

static void enter(const struct leap_map *map, const struct lanes *rays, const struct traverse_bundle *bundle,
                  struct places *out)
{
    reals known[3];
    bool outside = false;
    out->t = all(0);
    out->live = equal(out->t, out->t);
    truths none = less(out->t, out->t);
    truths crossed[3] = {none, none, none};
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        double start = bundle->start_cell[a];
        known[a] = all(start);
        bool below = start < map->first[a];
        if (below || start > map->last[a]) {
            double face = below ? map->first[a] : map->last[a];
            known[a] = all(face);
            reals t = ((known[a] - rays->sign[a] * 0.5) - rays->origin[a]) * rays->inverse[a];
            out->live &= below ? less(all(0), rays->sign[a]) : less(rays->sign[a], all(0));
            truths later = at_most(out->t, t);
            out->t = choose(later, t, out->t);
            for (int b = 0; b < a; b++) {
                crossed[b] &= ~later;
            }
            crossed[a] = later;
            outside = true;
        }
    }
    out->live &= at_most(out->t, rays->stop) & less(out->t, all(INFINITY));
    if (outside) {
        truths odd = find_cells(rays, out->t, crossed, known, out->cell);
        odd &= out->live;
        if (any(odd)) {
            enter_carefully(map, rays, out, odd);
        }
    } else {
        memcpy(out->cell, known, sizeof known);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) { /* lanes that missed stay where there are codes */
        out->cell[a] = choose(out->live, out->cell[a], all(0));
    }
}

/* Lanes at cells with codes leave the empty box around them. */
static INLINE void leap(const struct leap_map *map, const struct lanes *rays, struct places *at, reals codes)
{
    struct places next;
    reals times[3], known[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        reals reach = at->cell[a] + rays->sign[a] * (codes - 1);
        known[a] = reach + rays->sign[a];
        times[a] = exit_times(rays, a, reach);
    }
    truths crossed[3];
    crossed[0] = at_most(times[0], times[1]) & at_most(times[0], times[2]);
    crossed[1] = ~crossed[0] & at_most(times[1], times[2]);
    crossed[2] = ~crossed[0] & ~crossed[1];
    next.t = smaller(smaller(times[0], times[1]), times[2]);
    next.live = at->live & at_most(next.t, rays->stop);
    truths odd = find_cells(rays, next.t, crossed, known, next.cell) | equal(next.t, rays->stop);
    odd &= next.live;
    if (any(odd)) {
        leap_carefully(map, rays, at, codes - 1, &next, odd);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        at->cell[a] = choose(next.live, next.cell[a], at->cell[a]);
    }
    at->t = choose(next.live, next.t, at->t);
    at->live = next.live;
}

static void store(const struct leap_map *map, struct traverse_bundle *bundle, size_t first, const struct places *at,
                  truths hit)
{
    for (int l = 0; l < LANES; l++) {
        size_t i = (size_t)at->cell[0][l];
        size_t j = (size_t)at->cell[1][l];
        size_t k = (size_t)at->cell[2][l];
        bundle->t[first + (size_t)l] = is_true(hit, l) ? at->t[l] : INFINITY;
        bundle->voxel[first + (size_t)l] = is_true(hit, l) ? i + map->dim[0] * (j + map->dim[1] * k) : UINT64_MAX;
    }
}

/* A packet of rays on its way, and where it came from. */
struct packet {
    struct lanes rays;
    struct places at;
    reals codes; /* of the cells where it is: fetched a turn before they are needed */
    truths hit;
    size_t first; /* ray of the bundle; its count = none */
};

/* Lanes that meet an object stop, with their hit set; the others leap. */
static INLINE void advance(const struct leap_map *map, const struct layout *layout, struct packet *packet)
{
    reals codes = packet->codes;
    truths met = equal(codes, all(0));
    packet->hit |= packet->at.live & met;
    packet->at.live &= ~met;
    leap(map, &packet->rays, &packet->at, codes);
    packet->codes = codes_at(layout, packet->at.cell);
}

/* Delivers a packet whose lanes have all stopped and takes the bundle's next one that has any under way. */
static void renew(const struct leap_map *map, const struct layout *layout, struct traverse_bundle *bundle,
                  struct packet *packet, size_t *next)
{
    do {
        if (packet->first < bundle->count) {
            store(map, bundle, packet->first, &packet->at, packet->hit);
        }
        packet->first = *next;
        if (*next == bundle->count) {
            return;
        }
        load(&packet->rays, map, bundle, packet->first);
        enter(map, &packet->rays, bundle, &packet->at);
        packet->hit = less(all(0), all(0)); /* none */
        packet->codes = codes_at(layout, packet->at.cell);
        *next += LANES;
    } while (!any(packet->at.live));
}

/* Two packets at a time, so that one computes while the other waits for its codes. */
void KERNEL(const struct leap_map *map, struct traverse_bundle *bundle)
{
    struct layout layout;
    struct packet one = {.first = bundle->count};
    struct packet two = {.first = bundle->count};
    size_t next = 0;
    layout_init(&layout, map);
    renew(map, &layout, bundle, &one, &next);
    renew(map, &layout, bundle, &two, &next);
    while (any(one.at.live | two.at.live)) {
        advance(map, &layout, &one);
        advance(map, &layout, &two);
        if (!any(one.at.live)) {
            renew(map, &layout, bundle, &one, &next);
        }
        if (!any(two.at.live)) {
            renew(map, &layout, bundle, &two, &next);
        }
    }
}
