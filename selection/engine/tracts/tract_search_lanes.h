/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A kernel of the search: the including file says how many LANES there are, 4 or 8, and what the KERNEL is
 * called. */
#include "base/lanes_numbers.h"
#include "selection/engine/tracts/tract_search.h"

static INLINE singles dot(const singles a[3], const singles b[3])
{
    return multiply_add(a[0], b[0], multiply_add(a[1], b[1], a[2] * b[2]));
}

/* The search's ray in all lanes. */
struct ray {
    singles origin[3], direction[3];
    singles slack, limit;
};

static INLINE struct ray ray_of(const struct tract_search *search, float limit)
{
    struct ray ray = {.slack = all(search->from.slack), .limit = all(limit)};
    for (int a = 0; a < 3; a++) {
        ray.origin[a] = all(search->from.origin[a]);
        ray.direction[a] = all(search->from.direction[a]);
    }
    return ray;
}

/* ---- Boxes ------------------------------------------------------------------------------------------------------ */

/* Bit l: the ray may be in the box of lane l, grown by the radius, at the limit or before; enter[l] is from where. */
static INLINE unsigned boxes_hit(float enter[TRACT_WIDTH], const struct tract_search *search,
                                 const struct tract_node *node, float limit)
{
    float grown = search->from.radius + search->from.slack;
    unsigned bits = 0;
    for (int first = 0; first < TRACT_WIDTH; first += LANES) {
        singles in = all(-search->from.slack);
        singles out = all(limit);
        for (int a = 0; a < 3; a++) {
            bool back = search->from.inverse[a] < 0;
            singles near = singles_at((back ? node->high[a] : node->low[a]) + first);
            singles far = singles_at((back ? node->low[a] : node->high[a]) + first);
            singles inverse = all(search->from.inverse[a]);
            float more = back ? -grown : grown;
            in = larger(in, (near - all(search->from.origin[a] + more)) * inverse);
            out = smaller(out, (far - all(search->from.origin[a] - more)) * inverse);
        }
        store_singles(enter + first, in);
        bits |= bits_of(at_most(in, out)) << first;
    }
    return bits;
}

/* ---- Capsules --------------------------------------------------------------------------------------------------- */

static INLINE singles within_0_1(singles x)
{
    return larger(all(0), smaller(all(1), x));
}

/* Segments from a to b, seen along the ray: each is one of a plane, a + h e, and the ray is the plane's origin. */
struct seen {
    singles a[3], e[3];
    singles depth, deeper; /* along the ray: of a, and from there to b */
    singles square;        /* |e|^2; of what is shorter than the slack as if it were as long */
    singles nearest;       /* h of the line's nearest point to the ray */
};

static INLINE struct seen see(const struct ray *ray, const singles a[3], const singles b[3])
{
    struct seen out;
    singles to[3];
    for (int k = 0; k < 3; k++) {
        out.a[k] = a[k] - ray->origin[k];
        to[k] = b[k] - ray->origin[k];
    }
    out.depth = dot(out.a, ray->direction);
    out.deeper = dot(to, ray->direction) - out.depth;
    singles last = out.depth + out.deeper;
    for (int k = 0; k < 3; k++) {
        out.a[k] -= out.depth * ray->direction[k];
        out.e[k] = (to[k] - last * ray->direction[k]) - out.a[k];
    }
    out.square = larger(dot(out.e, out.e), ray->slack * ray->slack);
    out.nearest = -dot(out.a, out.e) / out.square;
    return out;
}

static INLINE singles square_at(const struct seen *seen, singles h)
{
    singles p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = multiply_add(h, seen->e[k], seen->a[k]);
    }
    return dot(p, p);
}

/* Whether the ray may be in capsules of a radius, at its limit or before. */
static INLINE truths is_near(const struct ray *ray, const struct seen *seen, singles radius)
{
    singles last = seen->depth + seen->deeper;
    return both_truths(at_most(square_at(seen, within_0_1(seen->nearest)), radius * radius),
                       both_truths(at_most(-ray->slack, larger(seen->depth, last) + radius),
                                   at_most(smaller(seen->depth, last) - radius, ray->limit)));
}

/* Where the ray comes into capsules that it is near to; the rest says whether it does. It is in the ball round the
 * point at h from depth(h) - sqrt(radius^2 - |a + h e|^2) on. That is least in a cylinder so far from the nearest point
 * as half of the ray's chord there times the sine of the angle between them; or, past an end, at the end. */
static INLINE singles entry(singles *rest, const struct seen *seen, singles radius)
{
    singles half = root(larger(all(0), radius * radius - square_at(seen, seen->nearest)));
    singles sine = seen->deeper / root(seen->square * (seen->square + seen->deeper * seen->deeper));
    singles h = within_0_1(seen->nearest - half * sine);
    *rest = radius * radius - square_at(seen, h);
    return multiply_add(h, seen->deeper, seen->depth) - root(larger(all(0), *rest));
}

/* From where on the ray may be in capsules that it is near to. What is about along the ray, and so only a few slacks
 * long in the plane, counts from its nearer end on. */
static INLINE singles may_enter(const struct ray *ray, const struct seen *seen, singles radius)
{
    singles rest;
    truths is_along = at_most(seen->square, all(16) * ray->slack * ray->slack);
    return choose(is_along, smaller(seen->depth, seen->depth + seen->deeper) - radius, entry(&rest, seen, radius));
}

/* Where the ray is in capsules for sure, in front of its origin; INFINITY = it may not be. */
static INLINE singles must_enter(const struct ray *ray, const struct seen *seen, singles radius)
{
    singles rest;
    singles at = entry(&rest, seen, radius) + ray->slack;
    truths is_hit = both_truths(at_most(all(0), radius), at_most(all(0), rest));
    return choose(both_truths(is_hit, at_most(ray->slack + ray->slack, at)), at, all(INFINITY));
}

static INLINE float least(singles x)
{
    float out = INFINITY;
    for (int l = 0; l < LANES; l++) {
        out = x[l] < out ? x[l] : out;
    }
    return out;
}

/* Runs of a leaf. */
struct runs {
    uint8_t ends[2][3][TRACT_LEAF], bend[TRACT_LEAF];
    uint8_t lane[TRACT_LEAF]; /* in the leaf */
    uint32_t count;
};

/* Those in lanes of a leaf from @p first on. */
static INLINE struct seen see_runs(singles *thickness, const struct ray *ray, const struct tract_leaf *leaf,
                                   const uint8_t ends[2][3][TRACT_LEAF], const uint8_t bend[TRACT_LEAF], uint32_t first)
{
    singles at[2][3];
    for (int e = 0; e < 2; e++) {
        for (int k = 0; k < 3; k++) {
            at[e][k] = multiply_add(singles_from_bytes(ends[e][k] + first), all(leaf->step[k]), all(leaf->low[k]));
        }
    }
    *thickness = singles_from_wholes(wholes_from_bytes(bend + first) >> TRACT_SEGMENTS_BITS) * all(leaf->thickness);
    return see(ray, at[0], at[1]);
}

/* Those that the ray may hit, side by side. */
static INLINE void take_near(struct runs *out, const struct tract_search *search, const struct ray *ray,
                             const struct tract_leaf *leaf)
{
    uint32_t bits = 0;
    for (uint32_t first = 0; first < TRACT_LEAF; first += LANES) {
        singles thickness;
        struct seen seen = see_runs(&thickness, ray, leaf, leaf->ends, leaf->bend, first);
        bits |= (uint32_t)bits_of(is_near(ray, &seen, all(search->from.radius + 2 * search->from.slack) + thickness))
                << first;
    }
    out->count = 0;
    for (bits &= 0xffffffffU >> (TRACT_LEAF - leaf->count); bits; bits &= bits - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(bits);
        for (int k = 0; k < 3; k++) {
            out->ends[0][k][out->count] = leaf->ends[0][k][lane];
            out->ends[1][k][out->count] = leaf->ends[1][k][lane];
        }
        out->bend[out->count] = leaf->bend[lane];
        out->lane[out->count++] = (uint8_t)lane;
    }
}

/* More than the way from an end to the point that it stands for. */
static INLINE float half_diagonal(const struct tract_leaf *leaf)
{
    float longest = leaf->step[0] > leaf->step[1] ? leaf->step[0] : leaf->step[1];
    return 0.87F * (leaf->step[2] > longest ? leaf->step[2] : longest);
}

/* Finds from where on the ray may hit each run. The bound becomes no more than where it must have hit one: every point
 * of the segment between a run's ends is no farther from the run than its thickness and, near an end, than what that is
 * off. */
static INLINE void find_entries(float enter[TRACT_LEAF], struct tract_search *search, const struct ray *ray,
                                const struct tract_leaf *leaf, const struct runs *runs)
{
    singles sure = all(search->bound);
    singles inner = all(search->from.radius - 2 * search->from.slack - half_diagonal(leaf));
    for (uint32_t first = 0; first < runs->count; first += LANES) {
        singles thickness;
        struct seen seen = see_runs(&thickness, ray, leaf, runs->ends, runs->bend, first);
        store_singles(enter + first,
                      may_enter(ray, &seen, all(search->from.radius + 2 * search->from.slack) + thickness));
        truths is_run = less(singles_from_wholes(lane_numbers() + (int32_t)first), all((float)runs->count));
        sure = smaller(choose(is_run, must_enter(ray, &seen, inner - thickness), all(INFINITY)), sure);
    }
    search->bound = search->has_bound ? least(sure) : search->bound;
}

/* ---- Segments --------------------------------------------------------------------------------------------------- */

enum { POINTS = 8 }; /* more than TRACT_RUN */
_Static_assert(POINTS % LANES == 0, "segments are settled LANES at a time");

/* The points of a run, axis by axis; the last one is repeated. */
static INLINE void take_points(float out[3][POINTS + 1], const struct tractogram *tractogram,
                               const struct tract_found *run)
{
    for (uint32_t k = 0; k <= POINTS; k++) {
        uint64_t index = 3 * (run->point + (k < run->segments ? k : run->segments));
        for (uint64_t a = 0; a < 3; a++) {
            out[a][k] = tractogram->points ? tractogram->points[index + a]
                                           : (float)tract_from_half(tractogram->halves[index + a]);
        }
    }
}

/* Bits of the segments that the ray may hit. */
static INLINE uint32_t segments_hit(struct tract_search *search, const struct tract_found *run, float limit)
{
    struct ray ray = ray_of(search, limit);
    singles sure = all(INFINITY);
    uint32_t bits = 0;
    float points[3][POINTS + 1];
    take_points(points, search->tractogram, run);
    for (uint32_t first = 0; first < TRACT_RUN; first += LANES) {
        singles a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = singles_at(points[k] + first);
            b[k] = singles_at(points[k] + first + 1);
        }
        struct seen seen = see(&ray, a, b);
        singles radius = all(search->from.radius + 2 * search->from.slack);
        truths hit = both_truths(is_near(&ray, &seen, radius), at_most(may_enter(&ray, &seen, radius), ray.limit));
        bits |= bits_of(hit) << first;
        sure = smaller(sure, must_enter(&ray, &seen, all(search->from.radius - 2 * search->from.slack)));
    }
    search->bound = search->has_bound ? least(smaller(sure, all(search->bound))) : search->bound;
    uint32_t count = run->segments ? run->segments : 1;
    return bits & ((1U << count) - 1);
}

/* ---- The search ------------------------------------------------------------------------------------------------- */

enum { LINE = 64 };

static INLINE void fetch_bytes(const void *from, size_t size)
{
    for (size_t at = 0; at < size; at += LINE) {
        __builtin_prefetch((const char *)from + at);
    }
}

static INLINE void fetch_points(const struct tractogram *tractogram, const struct tract_leaf *leaf, size_t lane)
{
    size_t size = tractogram->points ? sizeof *tractogram->points : sizeof *tractogram->halves;
    const char *points = tractogram->points ? (const char *)tractogram->points : (const char *)tractogram->halves;
    points += 3 * size * leaf->point[lane];
    __builtin_prefetch(points);
    __builtin_prefetch(points + 3 * size * tract_leaf_segments(leaf, lane));
}

/* What is read of an item when its turn comes, or the processor would wait for it then. */
static INLINE void fetch(const struct tract_search *search, uint32_t level, size_t item)
{
    const struct tract_tree *tree = &search->tractogram->tree;
    if (level == 0) {
        fetch_points(search->tractogram, &tree->leaves[item / TRACT_LEAF], item % TRACT_LEAF);
    } else if (level == 1) {
        fetch_bytes(&tree->leaves[item], sizeof *tree->leaves);
    } else {
        fetch_bytes(&tree->nodes[search->levels.first[level - 2] + item], sizeof *tree->nodes);
    }
}

/* Lets those runs of a leaf that the ray may hit be looked at later. */
static INLINE void open_leaf(struct tract_search *search, size_t number, float limit)
{
    const struct tract_leaf *leaf = &search->tractogram->tree.leaves[number];
    struct ray ray = ray_of(search, limit);
    struct runs runs;
    float enter[TRACT_LEAF];
    take_near(&runs, search, &ray, leaf);
    find_entries(enter, search, &ray, leaf, &runs);
    limit = search->bound < limit ? search->bound : limit;
    for (uint32_t k = 0; k < runs.count; k++) {
        size_t item = number * TRACT_LEAF + runs.lane[k];
        if (enter[k] <= limit) {
            search->runs[search->aside++] = (struct tract_visit){enter[k], 0, item};
        }
    }
}

/* Lets items from @p first on wait, the nearest one last, which comes first. */
static INLINE void let_wait(struct tract_search *search, uint32_t level, size_t first, unsigned bits,
                            const float *enter)
{
    size_t before = search->waiting;
    for (; bits; bits &= bits - 1) {
        unsigned lane = (unsigned)__builtin_ctz(bits);
        size_t place = search->waiting++;
        fetch(search, level, first + lane);
        for (; place > before && search->visits[place - 1].enter < enter[lane]; place--) {
            search->visits[place] = search->visits[place - 1];
        }
        search->visits[place] = (struct tract_visit){enter[lane], level, first + lane};
    }
}

/* Lets those items of a node wait that the ray may hit. */
static INLINE void open_node(struct tract_search *search, const struct tract_visit *visit, float limit)
{
    uint32_t level = visit->level - 2;
    size_t first = visit->item * TRACT_WIDTH;
    size_t left = search->levels.items[level] - first;
    const struct tract_node *node = &search->tractogram->tree.nodes[search->levels.first[level] + visit->item];
    float enter[TRACT_WIDTH];
    unsigned bits = boxes_hit(enter, search, node, limit);
    bits &= left < TRACT_WIDTH ? (1U << left) - 1 : (1U << TRACT_WIDTH) - 1;
    let_wait(search, level + 1, first, bits, enter);
}

/* Of the runs that were put aside those that are too far are dropped, and the nearest one comes first. */
static INLINE void sort_out(struct tract_search *search, float far)
{
    search->ready = 0;
    for (size_t i = 0; i < search->aside; i++) {
        struct tract_visit visit = search->runs[i];
        if (visit.enter <= far) {
            fetch(search, 0, visit.item);
            search->runs[search->ready++] = visit;
            if (visit.enter < search->runs[0].enter) {
                search->runs[search->ready - 1] = search->runs[0];
                search->runs[0] = visit;
            }
        }
    }
    search->aside = 0;
    search->next = 0;
}

/* Looks at the next run that is ready. */
static INLINE bool has_hit(struct tract_found *out, struct tract_search *search, float far)
{
    struct tract_visit visit = search->runs[search->next++];
    search->ready -= search->next == search->ready ? search->ready : 0;
    if (visit.enter > far) {
        return false;
    }
    const struct tract_leaf *leaf = &search->tractogram->tree.leaves[visit.item / TRACT_LEAF];
    out->point = leaf->point[visit.item % TRACT_LEAF];
    out->segments = tract_leaf_segments(leaf, visit.item % TRACT_LEAF);
    out->hit = segments_hit(search, out, far);
    return out->hit;
}

tract_search_next KERNEL;

bool KERNEL(struct tract_found *out, struct tract_search *search, double limit)
{
    float reach = tract_start_reach(limit, search->from.along, search->from.slack);
    while (search->waiting || search->aside || search->ready) {
        float far = reach < search->bound ? reach : search->bound;
        if (search->ready) {
            if (has_hit(out, search, far)) {
                return true;
            }
        } else if (search->waiting && search->aside <= TRACT_ASIDE - TRACT_LEAF) {
            struct tract_visit visit = search->visits[--search->waiting];
            if (visit.enter <= far && visit.level == 1) {
                open_leaf(search, visit.item, far);
            } else if (visit.enter <= far) {
                open_node(search, &visit, far);
            }
        } else {
            sort_out(search, far);
        }
    }
    return false;
}
