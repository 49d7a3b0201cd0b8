/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The walk of traverse_one() for LANES rays at a time: the body of one instruction set's kernel. pierce_lanes.h
 * includes it. The source of the instruction set defines LANES, KERNEL and PIERCE (the functions' names), includes
 * pierce_lanes.h once, and is compiled with that set's flags. * Positions are single precision, which holds twice as
 * many rays. They only decide which cell a ray is in. A ray that is nearer to a face than its error (model.md, Eq. 5)
 * is unclear, and goes to traverse_one() as a whole. Positions count from where the first ray may enter the box, which
 * is found in double. The contact's t follows from its cell alone, in double, by the same expressions as in
 * traverse_one(). Packets of LANES rays take turns, so that one works while another waits for memory. */
#include "base/simd/lanes.h"
#include "selection/engine/voxels/traverse.h"

#include <math.h>
#include <stdalign.h>

/* Error of the position where a ray's count begins, which is double, in cells. */
#define DOUBLE_ERROR 1e-6
/* Error of the positions after it, in units of the largest one; 17 roundings. */
#define SINGLE_ERROR 0x1.1p-20
/* Rays are counted from where the first of them is so many cells before the box. One that starts closer to it, and
 * outside, may not come in at all. */
#define BEFORE_BOX 0.25
/* A ray is out when it is past the middle of a cell beside the box. Where that is does not matter, as long as it is
 * within that cell and not near its faces: it is empty, and the map has a code for it. */
#define PAST_BOX 0.75F
/* A ray ends so many cells behind its limit, along its fastest axis: farther than the error. The exact t decides in
 * deliver(). */
#define PAST_LIMIT 0.25F
/* The largest error that still tells inside from outside, cells. */
#define SLOW 0.125F
/* Rays at more cells per mm, or at fewer than one by as many, are for double. */
#define FASTEST 0x1p60F

enum { PACKETS = TRAVERSE_BUNDLE / LANES };

/* The rays of a bundle, in the index space of the map with its origin moved to `middle`. */
struct walk {
    const struct distance_map *map;
    struct traverse_bundle *bundle;
    double least[3], most[3];                     /* of the directions */
    double begin;                                 /* mm from the rays' origin: no ray is in the box before */
    float error;                                  /* of positions, cells */
    int middle[3];                                /* a cell in the box, at which a line of the map begins, */
    const uint8_t *codes;                         /* its code */
    float first[3], last[3];                      /* of the map's box */
    alignas(64) float origin[3][TRAVERSE_BUNDLE]; /* at t = 0, here `begin` */
    float direction[3][TRAVERSE_BUNDLE];
    float inverse[3][TRAVERSE_BUNDLE];
    float clearance[3][TRAVERSE_BUNDLE]; /* farthest from a cell's middle that is clear after crossing that axis */
    float cell[3][TRAVERSE_BUNDLE];
    float stop[TRAVERSE_BUNDLE];                  /* t at which the ray is out        */
    int32_t at[TRAVERSE_BUNDLE];                  /* of the cell's code, from `codes` */
    alignas(64) double exact[3][TRAVERSE_BUNDLE]; /* direction */
    truths live[PACKETS], hit[PACKETS], unclear[PACKETS];
};

/* The directions, and the least and the most of them. */
static INLINE void aim(struct walk *walk)
{
    const struct traverse_bundle *bundle = walk->bundle;
    const double *m = bundle->index_from_world;
    doubles least[3], most[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        least[a] = all_doubles(INFINITY);
        most[a] = all_doubles(-INFINITY);
    }
    for (size_t slot = 0; slot < bundle->count; slot += HALF) {
        doubles x = doubles_at(bundle->direction[0] + slot);
        doubles y = doubles_at(bundle->direction[1] + slot);
        doubles z = doubles_at(bundle->direction[2] + slot);
        EACH_AXIS
        for (int a = 0; a < 3; a++) {
            doubles direction = m[a] * x + m[4 + a] * y + m[8 + a] * z; /* as mat4_direction() */
            least[a] = smaller_doubles(direction, least[a]);
            most[a] = larger_doubles(direction, most[a]);
            store_doubles(walk->exact[a] + slot, direction);
        }
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        walk->least[a] = least_of_doubles(least[a]);
        walk->most[a] = -least_of_doubles(-most[a]);
    }
}

/* a > b ? a : b, without a call. */
static INLINE double larger_of(double a, double b)
{
    return a > b ? a : b;
}

/* Where half a packet's rays begin in the index space of the map. */
static INLINE doubles starts_of(const struct walk *walk, int a, size_t slot)
{
    const struct traverse_bundle *bundle = walk->bundle;
    return bundle->is_apart ? doubles_at(bundle->starts[a] + slot) : all_doubles(bundle->start[a]);
}

/* Finds `begin`; false if no ray ever is in the box. */
static INLINE bool find_begin(struct walk *walk)
{
    double begin = 0; /* also where they start inside */
    for (int a = 0; a < 3; a++) {
        double before = (walk->map->first[a] - 0.5) - walk->bundle->high[a];
        double behind = (walk->map->last[a] + 0.5) - walk->bundle->low[a];
        if (before > 0) {
            begin = larger_of(begin, walk->most[a] > 0 ? (before - BEFORE_BOX) / walk->most[a] : INFINITY);
        } else if (behind < 0) {
            begin = larger_of(begin, walk->least[a] < 0 ? (behind + BEFORE_BOX) / walk->least[a] : INFINITY);
        }
    }
    walk->begin = begin;
    return begin < INFINITY;
}

/* Where the singles' origin is, and how good they are. */
static INLINE void place_middle(struct walk *walk)
{
    const struct distance_map *map = walk->map;
    double extent = 0;
    for (int a = 0; a < 3; a++) {
        double middle = floor((map->first[a] + map->last[a]) / 2 / DISTANCE_EDGE) * DISTANCE_EDGE - DISTANCE_MARGIN;
        double least = walk->bundle->low[a] - middle + walk->begin * walk->least[a];
        double most = walk->bundle->high[a] - middle + walk->begin * walk->most[a];
        extent = larger_of(extent, larger_of(map->last[a] - middle, middle - map->first[a]) + 1);
        extent = larger_of(extent, larger_of(most, -least));
        walk->middle[a] = (int)middle;
        walk->first[a] = (float)(map->first[a] - middle);
        walk->last[a] = (float)(map->last[a] - middle);
    }
    walk->error = (float)(extent * SINGLE_ERROR + DOUBLE_ERROR);
    walk->codes =
        map->codes + distance_map_at(map, (size_t)walk->middle[0], (size_t)walk->middle[1], (size_t)walk->middle[2]);
}

/* Whether any ray may be in the box. */
static bool walk_init(struct walk *walk, const struct distance_map *map, struct traverse_bundle *bundle)
{
    walk->map = map;
    walk->bundle = bundle;
    aim(walk);
    if (!find_begin(walk)) {
        return false;
    }
    place_middle(walk);
    return true;
}

/* A packet where its rays are counted from, and its limit there. */
struct packet {
    singles origin[3], direction[3], inverse[3], error[3];
    singles fastest; /* of the magnitudes of the direction, */
    singles slowest; /* and of those of the inverse         */
    singles stop;
    truths clear;
};

static INLINE void place(struct packet *out, const struct walk *walk, size_t slot)
{
    out->fastest = all(0);
    out->slowest = all(INFINITY);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        double middle = walk->middle[a];
        doubles low = doubles_at(walk->exact[a] + slot);
        doubles high = doubles_at(walk->exact[a] + slot + HALF);
        out->origin[a] = singles_from_doubles((starts_of(walk, a, slot) + walk->begin * low) - middle,
                                              (starts_of(walk, a, slot + HALF) + walk->begin * high) - middle);
        out->direction[a] = singles_from_doubles(low, high);
        out->inverse[a] = 1 / out->direction[a];
        out->fastest = larger(out->fastest, magnitude(out->direction[a]));
        out->slowest = smaller(out->slowest, magnitude(out->inverse[a]));
    }
    out->clear = less(out->fastest, all(FASTEST)) & less(all(1 / FASTEST), out->fastest);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        out->error[a] = walk->error * (1 + out->fastest * magnitude(out->inverse[a]));
    }
}

/* When the rays are out along an axis. */
static INLINE singles stop_along(const struct packet *packet, const struct walk *walk, int a)
{
    singles past =
        choose(less(packet->inverse[a], all(0)), all(walk->first[a] - PAST_BOX), all(walk->last[a] + PAST_BOX));
    return (past - packet->origin[a]) * packet->inverse[a];
}

static INLINE singles limit_of(const struct packet *packet, const struct walk *walk, size_t slot)
{
    const double *limit = walk->bundle->limit + slot;
    singles until = singles_from_doubles(doubles_at(limit) - walk->begin, doubles_at(limit + HALF) - walk->begin);
    return until + PAST_LIMIT * packet->slowest;
}

/* Where a ray moves so slowly along an axis that the error in when it crosses a face takes it far along the others, it
 * must not cross any there until it stops; then it does not move, for singles. Else it is unclear. */
static void keep_slow(struct packet *packet, const struct walk *walk)
{
    for (int a = 0; a < 3; a++) {
        if (any(less(packet->error[a], all(SLOW)))) {
            singles stop = smaller(packet->stop, stop_along(packet, walk, a));
            packet->stop = choose(less(packet->error[a], all(SLOW)), stop, packet->stop);
        }
    }
    for (int a = 0; a < 3; a++) {
        truths fast = less(packet->error[a], all(SLOW));
        singles x = packet->origin[a];
        singles way = magnitude(x - nearest(x)) + packet->stop * magnitude(packet->direction[a]);
        packet->clear &= fast | less(way, all(0.5F - walk->error));
        packet->inverse[a] = choose(fast, packet->inverse[a], all(INFINITY));
    }
}

/* When the rays come in along an axis. */
static INLINE singles entry_of(const struct packet *packet, const struct walk *walk, int a)
{
    singles face = choose(less(packet->inverse[a], all(0)), all(walk->last[a] + 0.5F), all(walk->first[a] - 0.5F));
    return (face - packet->origin[a]) * packet->inverse[a];
}

/* Exactly one of three. */
static INLINE truths one_of(const truths which[3])
{
    return (which[0] ^ which[1] ^ which[2]) & ~(which[0] & which[1] & which[2]);
}

/* The clearance of the axis whose crossing, of the three in `times`, is at t. */
static INLINE singles clearance_at(const struct walk *walk, size_t slot, singles t, const singles times[3])
{
    return choose(
        equal(t, times[0]), singles_at(walk->clearance[0] + slot),
        choose(equal(t, times[1]), singles_at(walk->clearance[1] + slot), singles_at(walk->clearance[2] + slot)));
}

/* The rays' cells where they come in. The axis whose face they cross there is the one that is near a face; with another
 * one near as well, or by chance none, the ray is unclear. Sets which come in at all. */
static INLINE truths find_cells(singles cell[3], truths *on, const struct packet *packet, const struct walk *walk,
                                size_t slot)
{
    singles times[3];
    truths near[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        times[a] = entry_of(packet, walk, a);
    }
    singles t = larger(larger(times[0], times[1]), times[2]);
    singles clearance = clearance_at(walk, slot, t, times);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles face = choose(less(packet->inverse[a], all(0)), all(walk->last[a]), all(walk->first[a]));
        singles x = multiply_add(t, packet->direction[a], packet->origin[a]);
        singles guess = nearest(x);
        near[a] = less(clearance, magnitude(x - guess));
        cell[a] = choose(near[a], face, guess);
    }
    *on = less(t, packet->stop) & less(t, all(INFINITY));
    return one_of(near) & at_most(all(0), t);
}

/* As traverse_cell(). */
static INLINE doubles cells_of(doubles x)
{
    doubles cell = floor_of_doubles(x + 0.5);
    doubles next = choose_doubles(at_most_doubles(cell + 0.5, x), cell + 1, cell);
    return choose_doubles(less_doubles(x, cell - 0.5), cell - 1, next);
}

/* All rays start in the box. */
static INLINE truths start_cells(singles cell[3], truths *on, const struct packet *packet, const struct walk *walk,
                                 size_t slot)
{
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        double middle = walk->middle[a];
        cell[a] = singles_from_doubles(cells_of(starts_of(walk, a, slot)) - middle,
                                       cells_of(starts_of(walk, a, slot + HALF)) - middle);
    }
    *on = less(all(0), packet->stop);
    return every();
}

/* Rays that come into the box before `from` begin there: in its cell or, where that is not in the box, nowhere. Where
 * it is near a face of the cell, the ray is unclear. Returns which are clear. */
static INLINE truths begin_later(singles cell[3], truths *on, truths clear, const struct packet *packet,
                                 const struct walk *walk, size_t slot)
{
    const double *at = walk->bundle->from + slot;
    singles from = singles_from_doubles(doubles_at(at) - walk->begin, doubles_at(at + HALF) - walk->begin);
    singles t = all(0);
    truths inside = every();
    truths sure = every();
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles entry = entry_of(packet, walk, a);
        t = choose(less(t, entry), entry, t);
    }
    truths later = less(t, from);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles x = multiply_add(from, packet->direction[a], packet->origin[a]);
        singles there = nearest(x);
        sure &= less(magnitude(x - there), all(0.5F - walk->error));
        inside &= at_most(all(walk->first[a]), there) & at_most(there, all(walk->last[a]));
        cell[a] = choose(later, there, cell[a]);
    }
    *on &= ~later | ~sure | inside;
    return (later & sure) | (~later & clear);
}

/* Notes where the codes of the lanes' cells are, as distance_map_at() says, and has them fetched: neighbours' are
 * mostly in the same lines, so every third will do. */
static INLINE void settle(struct walk *walk, size_t slot, const singles cell[3])
{
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

/* Brings a packet into the box. */
static INLINE void enter(struct walk *walk, size_t number)
{
    size_t slot = number * LANES;
    struct packet packet;
    singles cell[3];
    truths on;
    place(&packet, walk, slot);
    packet.stop = limit_of(&packet, walk, slot);
    truths slow =
        ~(less(packet.error[0], all(SLOW)) & less(packet.error[1], all(SLOW)) & less(packet.error[2], all(SLOW)));
    if (any(slow)) {
        keep_slow(&packet, walk);
    }
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        packet.stop = smaller(stop_along(&packet, walk, a), packet.stop);
        store_singles(walk->origin[a] + slot, packet.origin[a]);
        store_singles(walk->direction[a] + slot, packet.direction[a]);
        store_singles(walk->inverse[a] + slot, packet.inverse[a]);
        store_singles(walk->clearance[a] + slot, 0.5F - packet.error[a]);
    }
    store_singles(walk->stop + slot, packet.stop);
    truths clear = walk->bundle->starts_inside ? start_cells(cell, &on, &packet, walk, slot)
                                               : find_cells(cell, &on, &packet, walk, slot);
    if (walk->bundle->from) {
        clear = begin_later(cell, &on, clear, &packet, walk, slot);
    }
    walk->live[number] = on & clear & packet.clear;
    walk->unclear[number] = (on & ~clear) | ~packet.clear;
    walk->hit[number] = none();
    EACH_AXIS
    for (int a = 0; a < 3; a++) { /* rays that missed stay where there are codes */
        cell[a] = choose(walk->live[number], cell[a], all(0));
        store_singles(walk->cell[a] + slot, cell[a]);
    }
    settle(walk, slot, cell);
}

/* Moves live lanes out of the boxes around them; `codes` are 1 + the boxes' radii. Sets the lanes that go on and those
 * that are unclear. */
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
    singles clearance = clearance_at(walk, slot, t, times);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles x = multiply_add(t, singles_at(walk->direction[a] + slot), origin[a]);
        singles guess = nearest(x);
        near[a] = less(clearance, magnitude(x - guess)); /* as in find_cells() */
        known[a] = choose(near[a], known[a], guess);
    }
    truths clear = one_of(near);
    truths on = live & ~at_most(singles_at(walk->stop + slot), t);
    walk->unclear[packet] |= on & ~clear;
    on &= clear;
    walk->live[packet] = on;
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        cell[a] = choose(on, known[a], cell[a]);
        store_singles(walk->cell[a] + slot, cell[a]);
    }
    settle(walk, slot, cell);
}

/* Lanes that hit an object stop, with their hit set; the others leave the empty box around them. */
static INLINE void advance(struct walk *walk, size_t packet)
{
    wholes codes = bytes_at(walk->codes, walk->at + packet * LANES) - (int32_t)walk->map->shift;
    truths met = ~is_positive(codes);
    walk->hit[packet] |= walk->live[packet] & met;
    leave(walk, packet, codes, walk->live[packet] & ~met);
}

/* Stores the hits of half a packet, whose last crossing was of an axis that is 0, 1, or neither. */
static INLINE void deliver(const struct walk *walk, size_t slot, halves hit, halves is_0, halves is_1)
{
    struct traverse_bundle *bundle = walk->bundle;
    const size_t *dim = walk->map->dim;
    doubles cell[3], way[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles direction = doubles_at(walk->exact[a] + slot);
        doubles half = choose_doubles(less_doubles(direction, all_doubles(0)), all_doubles(-0.5), all_doubles(0.5));
        cell[a] = load_as_doubles(walk->cell[a] + slot) + (double)walk->middle[a];
        way[a] = (cell[a] - half) - starts_of(walk, a, slot);
    }
    doubles direction =
        choose_doubles(is_0, doubles_at(walk->exact[0] + slot),
                       choose_doubles(is_1, doubles_at(walk->exact[1] + slot), doubles_at(walk->exact[2] + slot)));
    doubles t = choose_doubles(is_0, way[0], choose_doubles(is_1, way[1], way[2])) * (1 / direction);
    t = choose_doubles(less_doubles(all_doubles(0), t), t, all_doubles(0));
    hit &= at_most_doubles(t, doubles_at(bundle->limit + slot));
    if (bundle->from) {
        t = choose_doubles(less_doubles(t, doubles_at(bundle->from + slot)), all_doubles(TRAVERSE_THERE), t);
    }
    longs voxel = longs_from_doubles(cell[0] + (double)dim[0] * (cell[1] + (double)dim[1] * cell[2]));
    store_doubles(bundle->t + slot, choose_doubles(hit, t, all_doubles(INFINITY)));
    store_longs(bundle->voxel + slot, choose_longs(hit, voxel, (longs){0} - 1));
}

/* A ray's entry into a cell is its last crossing of a face towards it. */
static INLINE void deliver_packet(const struct walk *walk, size_t packet)
{
    size_t slot = packet * LANES;
    singles times[3];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        singles inverse = singles_at(walk->inverse[a] + slot);
        singles face = singles_at(walk->cell[a] + slot) - with_sign(all(0.5F), inverse);
        times[a] = (face - singles_at(walk->origin[a] + slot)) * inverse;
    }
    singles t = larger(larger(times[0], times[1]), times[2]);
    wholes object = bytes_at(walk->codes, walk->at + slot) + (int32_t)walk->map->least;
    store_wholes((int32_t *)walk->bundle->object + slot, object); /* of a map that is labelled, or it is not asked */
    truths is_0 = equal(t, times[0]);
    truths is_1 = equal(t, times[1]);
    for (int half = 0; half < 2; half++) {
        deliver(walk, slot + (size_t)half * HALF, half_of(walk->hit[packet], half), half_of(is_0, half),
                half_of(is_1, half));
    }
}

static void deliver_all(const struct walk *walk)
{
    for (size_t packet = 0; packet * LANES < walk->bundle->count; packet++) {
        size_t slot = packet * LANES;
        deliver_packet(walk, packet);
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
        enter(walk, packet);
        under_way[count] = (uint8_t)packet;
        count += any(walk->live[packet]);
    }
    return count;
}

static void miss_all(struct traverse_bundle *bundle)
{
    for (size_t i = 0; i < bundle->count; i++) {
        bundle->t[i] = INFINITY;
        bundle->voxel[i] = UINT64_MAX;
    }
}

void KERNEL(const struct distance_map *map, struct traverse_bundle *bundle)
{
    struct walk walk;
    uint8_t under_way[PACKETS];
    if (!walk_init(&walk, map, bundle)) {
        miss_all(bundle);
        return;
    }
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
