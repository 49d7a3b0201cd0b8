/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The walk of traverse_one() for LANES rays at a time: the body of one instruction set's kernel. Its source defines
 * LANES and KERNEL (the function's name), includes this once, and is compiled with that set's flags.
 *
 * Positions are single precision, which holds twice as many rays, and only have to tell cells: where a ray is nearer to
 * a face than its error (model.md, Eq. 5), it is said to be unclear and goes to traverse_one() as a whole. The
 * contact's t follows from its cell alone, in double, with the same expressions as there. All packets of LANES rays
 * take a turn after each other, so that one's waiting for memory is another's time. */
#include "base/lanes.h"
#include "selection/engine/voxels/traverse.h"

#include <math.h>
#include <stdalign.h>

/* Of the position where a ray comes into the box, which is double, in cells. */
#define DOUBLE_ERROR 1e-6
/* Of the positions behind it, in units of the largest one; eight roundings and a bit. */
#define SINGLE_ERROR 0x1p-21
/* A ray is out when it is past the middle of a cell beside the box. Where that is does not matter, as long as it is
 * within that cell and not near its faces: it is empty, and the map has a code for it. */
#define PAST_BOX 0.75
/* A ray is beyond its limit so many cells, along its fastest axis, behind it: farther than the error. What counts is
 * the exact t in deliver(). */
#define PAST_LIMIT 0.25
/* The largest error with which what is out and what is not can be told apart, cells. */
#define SLOW 0.125
/* Rays at more cells per mm, or at fewer than one by as many, are for double. */
#define FASTEST 0x1p60

enum { PACKETS = TRAVERSE_BUNDLE / LANES };

/* The rays of a bundle, in the index space of the map with its origin moved to `middle`. */
struct walk {
    const struct distance_map *map;
    struct traverse_bundle *bundle;
    double error;                                 /* of positions, cells */
    int middle[3];                                /* a cell in the box, at which a line of the map begins, */
    const uint8_t *codes;                         /* its code */
    alignas(64) float origin[3][TRAVERSE_BUNDLE]; /* at t = 0, here the entry into the box */
    float direction[3][TRAVERSE_BUNDLE];
    float inverse[3][TRAVERSE_BUNDLE];
    float clearance[3][TRAVERSE_BUNDLE]; /* farthest from a cell's middle that is clear after crossing that axis */
    float cell[3][TRAVERSE_BUNDLE];
    float stop[TRAVERSE_BUNDLE];                  /* t at which the ray is out        */
    int32_t at[TRAVERSE_BUNDLE];                  /* of the cell's code, from `codes` */
    alignas(64) double exact[3][TRAVERSE_BUNDLE]; /* inverse */
    truths live[PACKETS], hit[PACKETS], unclear[PACKETS];
};

static void walk_init(struct walk *walk, const struct distance_map *map, struct traverse_bundle *bundle)
{
    double extent = 0;
    walk->map = map;
    walk->bundle = bundle;
    for (int a = 0; a < 3; a++) {
        double middle = floor((map->first[a] + map->last[a]) / 2 / DISTANCE_EDGE) * DISTANCE_EDGE - DISTANCE_MARGIN;
        extent = fmax(extent, fmax(map->last[a] - middle, middle - map->first[a]) + 1);
        walk->middle[a] = (int)middle;
    }
    walk->error = extent * SINGLE_ERROR + DOUBLE_ERROR;
    walk->codes =
        map->codes + distance_map_at(map, (size_t)walk->middle[0], (size_t)walk->middle[1], (size_t)walk->middle[2]);
}

/* ---- Into the box ------------------------------------------------------------------------------------------- */

/* Half a packet, as traverse_ray_init() makes rays. */
struct half {
    doubles origin[3], direction[3], inverse[3], sign[3];
    doubles fastest; /* of the magnitudes of the direction */
};

static INLINE void aim(struct half *out, const struct traverse_bundle *bundle, size_t first)
{
    const double *m = bundle->index_from_world;
    doubles world[3];
    out->fastest = all_doubles(0);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        world[a] = doubles_at(bundle->direction[a] + first);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles direction = m[a] * world[0] + m[4 + a] * world[1] + m[8 + a] * world[2]; /* as mat4_direction() */
        doubles inverse = 1 / direction;
        halves moves = less_doubles(magnitude_of_doubles(inverse), all_doubles(INFINITY));
        out->origin[a] = choose_doubles(moves, all_doubles(bundle->start[a]), all_doubles(bundle->start_cell[a]));
        out->direction[a] = choose_doubles(moves, direction, all_doubles(0));
        out->inverse[a] = choose_doubles(moves, inverse, all_doubles(INFINITY));
        out->sign[a] = choose_doubles(moves & less_doubles(direction, all_doubles(0)), all_doubles(-1), all_doubles(1));
        doubles speed = magnitude_of_doubles(out->direction[a]);
        out->fastest = choose_doubles(less_doubles(out->fastest, speed), speed, out->fastest);
    }
}

/* When the rays come in; 0 if they are in already. */
static INLINE doubles entry_of(const struct half *rays, const struct distance_map *map)
{
    doubles t = all_doubles(0);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles face = choose_doubles(less_doubles(all_doubles(0), rays->sign[a]), all_doubles(map->first[a] - 0.5),
                                      all_doubles(map->last[a] + 0.5));
        doubles entry = (face - rays->origin[a]) * rays->inverse[a];
        t = choose_doubles(less_doubles(t, entry), entry, t);
    }
    return t;
}

/* When they are past it or their limit, counted from t. */
static INLINE doubles stop_of(const struct half *rays, const struct distance_map *map, doubles limit, doubles t)
{
    doubles stop = (limit - t) + PAST_LIMIT / rays->fastest;
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles past = choose_doubles(less_doubles(all_doubles(0), rays->sign[a]), all_doubles(map->last[a] + PAST_BOX),
                                      all_doubles(map->first[a] - PAST_BOX));
        doubles exit = (past - rays->origin[a]) * rays->inverse[a] - t;
        stop = choose_doubles(less_doubles(exit, stop), exit, stop);
    }
    return stop;
}

/* Exactly one of three. */
static INLINE halves one_of_halves(const halves which[3])
{
    return (which[0] ^ which[1] ^ which[2]) & ~(which[0] & which[1] & which[2]);
}

/* Their cells at t. The axis whose face they cross there is the one that is near a face; with another one near as well,
 * or by chance none, the ray is unclear. */
static INLINE halves find_cells(doubles cell[3], const struct half *rays, const struct walk *walk, doubles t)
{
    halves near[3];
    halves inside = at_most_doubles(t, all_doubles(0));
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles face = choose_doubles(less_doubles(all_doubles(0), rays->sign[a]), all_doubles(walk->map->first[a]),
                                      all_doubles(walk->map->last[a]));
        doubles x = rays->origin[a] + t * rays->direction[a];
        doubles guess = nearest_doubles(x);
        near[a] = less_doubles(all_doubles(0.5 - DOUBLE_ERROR), magnitude_of_doubles(x - guess));
        guess = choose_doubles(near[a], face, guess);
        cell[a] = choose_doubles(inside, all_doubles(walk->bundle->start_cell[a]), guess);
    }
    return inside | one_of_halves(near);
}

/* Notes the rays from t on. Where one moves so slowly along an axis that the error in when it crosses a face takes it
 * far along the others, it must not cross any there until it stops; then it does not move, for singles. Else it is
 * unclear. */
static INLINE halves keep_rays(struct walk *walk, size_t slot, const struct half *rays, doubles t, doubles stop)
{
    halves clear =
        less_doubles(rays->fastest, all_doubles(FASTEST)) & less_doubles(all_doubles(1 / FASTEST), rays->fastest);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles x = rays->origin[a] + t * rays->direction[a];
        doubles error = walk->error * (1 + rays->fastest * magnitude_of_doubles(rays->inverse[a]));
        doubles inverse = rays->inverse[a];
        halves fast = less_doubles(error, all_doubles(SLOW));
        if (!all_halves(fast)) {
            doubles way =
                magnitude_of_doubles(x - nearest_doubles(x)) + stop * magnitude_of_doubles(rays->direction[a]);
            halves stays = ~fast & less_doubles(way, all_doubles(0.5 - walk->error));
            inverse = choose_doubles(stays, all_doubles(INFINITY), inverse);
            clear &= fast | stays;
        }
        store_as_singles(walk->origin[a] + slot, x - (double)walk->middle[a]);
        store_as_singles(walk->direction[a] + slot, rays->direction[a]);
        store_as_singles(walk->inverse[a] + slot, inverse);
        store_as_singles(walk->clearance[a] + slot, 0.5 - error);
        store_doubles(walk->exact[a] + slot, rays->inverse[a]);
    }
    return clear;
}

/* Brings half a packet into the box. */
static INLINE void enter(struct walk *walk, size_t slot, halves *live, halves *unclear)
{
    struct half rays;
    doubles cell[3];
    aim(&rays, walk->bundle, slot);
    doubles t = entry_of(&rays, walk->map);
    doubles stop = stop_of(&rays, walk->map, doubles_at(walk->bundle->limit + slot), t);
    halves clear = find_cells(cell, &rays, walk, t);
    halves on = less_doubles(all_doubles(0), stop) & less_doubles(t, all_doubles(INFINITY));
    clear &= keep_rays(walk, slot, &rays, t, stop);
    store_as_singles(walk->stop + slot, stop);
    *live = on & clear;
    *unclear = on & ~clear;
    EACH_AXIS
    for (int a = 0; a < 3; a++) { /* rays that missed stay where there are codes */
        doubles place = choose_doubles(*live, cell[a] - (double)walk->middle[a], all_doubles(0));
        store_as_singles(walk->cell[a] + slot, place);
    }
}

/* ---- From cell to cell -------------------------------------------------------------------------------------- */

/* Notes where the codes of the lanes' cells are, as distance_map_at() says, and has them fetched: neighbours' are
 * mostly in the same lines, so every third will do. */
static INLINE void settle(struct walk *walk, size_t slot)
{
    const singles cell[3] = {singles_at(walk->cell[0] + slot), singles_at(walk->cell[1] + slot),
                             singles_at(walk->cell[2] + slot)};
    const int32_t columns = (int32_t)walk->map->lines[0];
    const int32_t rows = (int32_t)walk->map->lines[1];
    wholes x = wholes_from_singles(cell[0]);
    wholes y = wholes_from_singles(cell[1]);
    wholes z = wholes_from_singles(cell[2]);
    wholes line = (x >> 2) + columns * ((y >> 2) + rows * (z >> 2));
    int32_t *at = walk->at + slot;
    store_wholes(at, (line << 6) | (x & 3) | (((y << 2) & 12) | ((z << 4) & 48)));
    for (int l = 0; l < LANES; l += 3) {
        __builtin_prefetch(walk->codes + at[l]);
    }
}

/* Live lanes leave the boxes around them; `codes` are 1 + the radii of these. Sets what goes on, and what is unclear.
 */
static INLINE void leave(struct walk *walk, size_t packet, wholes codes, truths live)
{
    size_t slot = packet * LANES;
    singles cell[3], origin[3], inverse[3], times[3], known[3];
    truths near[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        cell[a] = singles_at(walk->cell[a] + slot);
        origin[a] = singles_at(walk->origin[a] + slot);
        inverse[a] = singles_at(walk->inverse[a] + slot);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        known[a] = cell[a] + with_sign(singles_from_wholes(codes), inverse[a]);
        times[a] = ((known[a] - with_sign(all(0.5F), inverse[a])) - origin[a]) * inverse[a];
    }
    singles t = smaller(smaller(times[0], times[1]), times[2]);
    singles clearance = choose(
        equal(t, times[0]), singles_at(walk->clearance[0] + slot),
        choose(equal(t, times[1]), singles_at(walk->clearance[1] + slot), singles_at(walk->clearance[2] + slot)));
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles x = multiply_add(t, singles_at(walk->direction[a] + slot), origin[a]);
        singles guess = nearest(x);
        near[a] = less(clearance, magnitude(x - guess)); /* as in find_cells() */
        known[a] = choose(near[a], known[a], guess);
    }
    truths clear = (near[0] ^ near[1] ^ near[2]) & ~(near[0] & near[1] & near[2]);
    truths on = live & ~at_most(singles_at(walk->stop + slot), t);
    walk->unclear[packet] |= on & ~clear;
    on &= clear;
    walk->live[packet] = on;
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        store_singles(walk->cell[a] + slot, choose(on, known[a], cell[a]));
    }
    settle(walk, slot);
}

/* Lanes that hit an object stop, with their hit set; the others leave the empty box around them. */
static INLINE void advance(struct walk *walk, size_t packet)
{
    wholes codes = bytes_at(walk->codes, walk->at + packet * LANES);
    truths met = is_zero(codes);
    walk->hit[packet] |= walk->live[packet] & met;
    leave(walk, packet, codes, walk->live[packet] & ~met);
}

/* ---- What was hit ------------------------------------------------------------------------------------------- */

/* A ray's entry into a cell is its last crossing of a face towards it. Also gives the cells. */
static INLINE doubles entry_into_cell(doubles cell[3], const struct walk *walk, size_t slot)
{
    doubles t = all_doubles(0);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles inverse = doubles_at(walk->exact[a] + slot);
        doubles half = choose_doubles(less_doubles(all_doubles(0), inverse), all_doubles(0.5), all_doubles(-0.5));
        halves moves = less_doubles(inverse, all_doubles(INFINITY));
        cell[a] = load_as_doubles(walk->cell[a] + slot) + (double)walk->middle[a];
        doubles entry = ((cell[a] - half) - walk->bundle->start[a]) * inverse;
        t = choose_doubles(moves & less_doubles(t, entry), entry, t);
    }
    return t;
}

static INLINE void deliver(const struct walk *walk, size_t slot, halves hit)
{
    struct traverse_bundle *bundle = walk->bundle;
    const size_t *dim = walk->map->dim;
    doubles cell[3];
    doubles t = entry_into_cell(cell, walk, slot);
    hit &= at_most_doubles(t, doubles_at(bundle->limit + slot));
    longs voxel = longs_from_doubles(cell[0] + (double)dim[0] * (cell[1] + (double)dim[1] * cell[2]));
    store_doubles(bundle->t + slot, choose_doubles(hit, t, all_doubles(INFINITY)));
    store_longs(bundle->voxel + slot, choose_longs(hit, voxel, (longs){0} - 1));
}

static void deliver_all(const struct walk *walk)
{
    for (size_t packet = 0; packet * LANES < walk->bundle->count; packet++) {
        size_t slot = packet * LANES;
        deliver(walk, slot, half_of(walk->hit[packet], 0));
        deliver(walk, slot + HALF, half_of(walk->hit[packet], 1));
        for (int l = 0; l < LANES && any(walk->unclear[packet]); l++) {
            if (is_true(walk->unclear[packet], l)) {
                traverse_bundle_ray(walk->map, walk->bundle, slot + (size_t)l);
            }
        }
    }
}

/* Brings all rays into the box; lists the packets in which some are, and gives their number. */
static INLINE size_t enter_all(struct walk *walk, uint8_t under_way[PACKETS])
{
    size_t count = 0;
    for (size_t packet = 0; packet * LANES < walk->bundle->count; packet++) {
        halves live[2], unclear[2];
        enter(walk, packet * LANES, &live[0], &unclear[0]);
        enter(walk, packet * LANES + HALF, &live[1], &unclear[1]);
        walk->live[packet] = both(live[0], live[1]);
        walk->unclear[packet] = both(unclear[0], unclear[1]);
        walk->hit[packet] = none();
        settle(walk, packet * LANES);
        under_way[count] = (uint8_t)packet;
        count += any(walk->live[packet]);
    }
    return count;
}

void KERNEL(const struct distance_map *map, struct traverse_bundle *bundle)
{
    struct walk walk;
    uint8_t under_way[PACKETS];
    walk_init(&walk, map, bundle);
    size_t count = enter_all(&walk, under_way);
    while (count > 0) {
        size_t left = 0;
        for (size_t i = 0; i < count; i++) {
            size_t packet = under_way[i];
            advance(&walk, packet);
            under_way[left] = (uint8_t)packet;
            left += any(walk.live[packet]);
        }
        count = left;
    }
    deliver_all(&walk);
}
