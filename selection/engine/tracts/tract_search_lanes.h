/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A kernel of the search: the including file says how many LANES there are, 4 or 8, and what the KERNEL is
 * called. */
#include "base/simd/lanes.h"
#include "selection/engine/tracts/tract_rays.h"

/* The search's ray in all lanes. */
struct ray {
    singles axes[3][3]; /* two across it, and its own */
    singles slack, limit;
};

static INLINE struct ray ray_of(const struct tract_search *search, float limit)
{
    struct ray ray = {.slack = all(search->from.slack), .limit = all(limit)};
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) {
            ray.axes[i][a] = all(search->axes[i][a]);
        }
    }
    return ray;
}

/* Where a ray is in items of a node at most, from one place to another. */
struct stay {
    singles in, out;
};

/* The stay in the slabs of boxes that are grown by the radius. */
static INLINE struct stay stay_in_boxes(const struct tract_search *search, const struct tract_node *node, int first,
                                        float limit)
{
    float grown = search->from.radius + search->from.slack;
    struct stay stay = {all(-search->from.slack), all(limit)};
    for (int a = 0; a < 3; a++) {
        bool back = search->from.inverse[a] < 0;
        singles near = singles_at((back ? node->high[a] : node->low[a]) + first);
        singles far = singles_at((back ? node->low[a] : node->high[a]) + first);
        singles inverse = all(search->from.inverse[a]);
        float more = back ? -grown : grown;
        stay.in = larger(stay.in, (near - all(search->from.origin[a] + more)) * inverse);
        stay.out = smaller(stay.out, (far - all(search->from.origin[a] - more)) * inverse);
    }
    return stay;
}

/* Cuts the stay by the slabs along the diagonals of the boxes. There places are sums of three coordinates, so what
 * grows a box by 1 mm grows these slabs by a root of 3. All that is rounded on the way is less than 100 times 2^-24,
 * which is 6e-6, of the largest coordinate and the radius. The slack, times the root, is 17e-6 of it: nothing is lost.
 */
static INLINE void cut_stay(struct stay *stay, const struct tract_search *search, const struct tract_node *node,
                            int first)
{
    float grown = 1.7320509F * (search->from.radius + search->from.slack);
    singles low[3], high[3];
    singles length = all(0);
    for (int a = 0; a < 3; a++) {
        low[a] = singles_at(node->low[a] + first) - all(search->from.origin[a]);
        high[a] = singles_at(node->high[a] + first) - all(search->from.origin[a]);
        length = length + (high[a] - low[a]);
    }
    singles part = length * all(1.0F / TRACT_CUTS);
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        bool back = search->slopes[d] < 0;
        singles slope = all(search->slopes[d]);
        singles corner = all(-grown);
        for (int a = 0; a < 3; a++) {
            corner = tract_diagonal(d, a) > 0 ? corner + low[a] : corner - high[a];
        }
        singles from = multiply_add(part, singles_from_bytes(node->cut[0][d] + first), corner);
        singles end = corner + length + all(2 * grown) - part * singles_from_bytes(node->cut[1][d] + first);
        stay->in = larger(stay->in, (back ? end : from) * slope);
        stay->out = smaller(stay->out, (back ? from : end) * slope);
    }
}

/* Bit l: the ray may be in the item of lane l at the limit or before; enter[l] is from where. */
static INLINE unsigned boxes_hit(float enter[TRACT_WIDTH], const struct tract_search *search,
                                 const struct tract_node *node, float limit)
{
    unsigned bits = 0;
    for (int first = 0; first < TRACT_WIDTH; first += LANES) {
        struct stay stay = stay_in_boxes(search, node, first, limit);
        if (bits_of(at_most(stay.in, stay.out))) {
            cut_stay(&stay, search, node, first);
        }
        store_singles(enter + first, stay.in);
        bits |= bits_of(at_most(stay.in, stay.out)) << first;
    }
    return bits;
}

static INLINE singles within_0_1(singles x)
{
    return larger(all(0), smaller(all(1), x));
}

/* Segments from a to b, seen along the ray: each is one of a plane, a + h e, and the ray is the plane's origin. */
struct seen {
    singles a[2], e[2];
    singles depth, deeper; /* along the ray: of a, and from there to b */
    singles square;        /* |e|^2, at least the square of the slack */
    singles nearest;       /* h of the line's nearest point to the ray */
};

/* From the ends by the ray's axes. */
static INLINE struct seen see(const struct ray *ray, const singles a[3], const singles b[3])
{
    struct seen out = {.a = {a[0], a[1]}, .e = {b[0] - a[0], b[1] - a[1]}, .depth = a[2], .deeper = b[2] - a[2]};
    out.square = larger(multiply_add(out.e[0], out.e[0], out.e[1] * out.e[1]), ray->slack * ray->slack);
    out.nearest = -multiply_add(out.a[0], out.e[0], out.a[1] * out.e[1]) / out.square;
    return out;
}

static INLINE singles square_at(const struct seen *seen, singles h)
{
    singles x = multiply_add(h, seen->e[0], seen->a[0]);
    singles y = multiply_add(h, seen->e[1], seen->a[1]);
    return multiply_add(x, x, y * y);
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
    singles chord = larger(all(0), radius * radius - square_at(seen, seen->nearest)); /* half of it, squared */
    singles shift = seen->deeper * root(chord / (seen->square * (seen->square + seen->deeper * seen->deeper)));
    singles h = within_0_1(seen->nearest - shift);
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

/* How bytes of a leaf become coordinates by the ray's axes. */
struct scale {
    singles low[3], step[3][3];
};

static INLINE struct scale scale_of(const struct tract_search *search, const struct tract_leaf *leaf)
{
    struct scale out;
    float low[3];
    for (int a = 0; a < 3; a++) {
        low[a] = leaf->low[a] - search->from.origin[a];
    }
    for (int i = 0; i < 3; i++) {
        const float *axis = search->axes[i];
        out.low[i] = all(axis[0] * low[0] + axis[1] * low[1] + axis[2] * low[2]);
        for (int a = 0; a < 3; a++) {
            out.step[i][a] = all(axis[a] * leaf->step[a]);
        }
    }
    return out;
}

/* The runs in lanes of a leaf from @p first on. */
static INLINE struct seen see_runs(const struct ray *ray, const struct scale *scale, const struct tract_leaf *leaf,
                                   uint32_t first)
{
    singles at[2][3];
    for (int e = 0; e < 2; e++) {
        singles x = singles_from_bytes(leaf->ends[e][0] + first);
        singles y = singles_from_bytes(leaf->ends[e][1] + first);
        singles z = singles_from_bytes(leaf->ends[e][2] + first);
        for (int i = 0; i < 3; i++) {
            const singles *step = scale->step[i];
            at[e][i] = multiply_add(x, step[0], multiply_add(y, step[1], multiply_add(z, step[2], scale->low[i])));
        }
    }
    return see(ray, at[0], at[1]);
}

enum { POINTS = 8 }; /* more than TRACT_RUN */
_Static_assert(POINTS % LANES == 0, "segments are settled LANES at a time");

/* The points of a run from the search's origin on, axis by axis; the last one is repeated. */
static INLINE void take_points(float out[3][POINTS + 1], const struct tract_search *search,
                               const struct tract_found *run)
{
    const struct tractogram *tractogram = search->tractogram;
    for (uint32_t k = 0; k <= POINTS; k++) {
        uint64_t index = 3 * (run->point + (uint64_t)(k < run->segments ? k : run->segments));
        for (uint64_t a = 0; a < 3; a++) {
            float at = tractogram->points ? tractogram->points[index + a]
                                          : (float)tract_from_half(tractogram->halves[index + a]);
            out[a][k] = at - search->from.origin[a];
        }
    }
}

static INLINE singles along_axis(const singles axis[3], float points[3][POINTS + 1], uint32_t first)
{
    singles x = singles_at(points[0] + first);
    singles y = singles_at(points[1] + first);
    singles z = singles_at(points[2] + first);
    return multiply_add(axis[0], x, multiply_add(axis[1], y, axis[2] * z));
}

/* Bits of the segments that the ray may hit. */
static INLINE uint32_t segments_hit(struct tract_search *search, const struct tract_found *run, float limit)
{
    struct ray ray = ray_of(search, limit);
    singles sure = all(INFINITY);
    uint32_t bits = 0;
    float points[3][POINTS + 1];
    take_points(points, search, run);
    for (uint32_t first = 0; first < TRACT_RUN; first += LANES) {
        singles a[3], b[3];
        for (int i = 0; i < 3; i++) {
            a[i] = along_axis(ray.axes[i], points, first);
            b[i] = along_axis(ray.axes[i], points, first + 1);
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

enum { LINE = 64 };

static INLINE void fetch_bytes(const void *from, size_t size)
{
    for (size_t at = 0; at < size; at += LINE) {
        __builtin_prefetch((const char *)from + at);
    }
}

/* Fetches what is read of an item when its turn comes; the processor would wait for it then. */
static INLINE void fetch(const struct tract_search *search, uint32_t level, size_t item)
{
    const struct tract_tree *tree = &search->tractogram->tree;
    if (level == 0) {
        const struct tract_leaf *leaf = &tree->leaves[item / TRACT_LEAF];
        tract_fetch_points(search->tractogram, leaf->point[item % TRACT_LEAF],
                           tract_leaf_segments(leaf, item % TRACT_LEAF));
    } else if (level == 1) {
        fetch_bytes(&tree->leaves[item], sizeof *tree->leaves);
    } else {
        fetch_bytes(&tree->nodes[search->levels.first[level - 2] + item], sizeof *tree->nodes);
    }
}

/* Runs in lanes of a leaf, and what is a little more and a little less than their radius. */
struct lanes {
    struct seen seen;
    singles outer, inner;
};

/* Every point of the segment between a run's ends is no farther from the run than its thickness and, near an end, than
 * what rounding does to that. */
static INLINE struct lanes lanes_of(const struct tract_search *search, const struct ray *ray, const struct scale *scale,
                                    const struct tract_leaf *leaf, uint32_t first)
{
    singles thickness =
        singles_from_wholes(wholes_from_bytes(leaf->bend + first) >> TRACT_SEGMENTS_BITS) * all(leaf->thickness);
    return (struct lanes){
        see_runs(ray, scale, leaf, first), all(search->from.radius + 2 * search->from.slack) + thickness,
        all(search->from.radius - 2 * search->from.slack - 1.01F * (float)tract_leaf_rounding(leaf)) - thickness};
}

/* Lets those runs of a leaf that the ray may hit be looked at later. The bound becomes no more than where it must have
 * hit one. */
static INLINE void open_leaf(struct tract_search *search, size_t number, float limit)
{
    const struct tract_leaf *leaf = &search->tractogram->tree.leaves[number];
    const struct ray ray = ray_of(search, limit);
    const struct scale scale = scale_of(search, leaf);
    const uint32_t used = 0xffffffffU >> (TRACT_LEAF - leaf->count);
    singles sure = all(search->bound);
    for (uint32_t first = 0; first < TRACT_LEAF; first += LANES) {
        struct lanes lanes = lanes_of(search, &ray, &scale, leaf, first);
        uint32_t bits = bits_of(is_near(&ray, &lanes.seen, lanes.outer)) & used >> first;
        if (!bits) {
            continue;
        }
        float enter[LANES];
        singles from = may_enter(&ray, &lanes.seen, lanes.outer);
        bits &= bits_of(at_most(from, ray.limit));
        if (bits && search->has_bound) {
            truths is_run = less(singles_from_wholes(lane_numbers() + (int32_t)first), all((float)leaf->count));
            sure = smaller(choose(is_run, must_enter(&ray, &lanes.seen, lanes.inner), all(INFINITY)), sure);
        }
        store_singles(enter, from);
        for (; bits; bits &= bits - 1) {
            uint32_t lane = (uint32_t)__builtin_ctz(bits);
            search->runs[search->aside++] = (struct tract_visit){enter[lane], 0, number * TRACT_LEAF + first + lane};
        }
    }
    search->bound = search->has_bound ? least(sure) : search->bound;
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

/* How many runs are fetched before they are looked at: the nearest one may keep the others from being read at all. */
enum { AHEAD = 8 };

static INLINE void fetch_ready(const struct tract_search *search, size_t index, float far)
{
    if (index < search->ready && search->runs[index].enter <= far) {
        fetch(search, 0, search->runs[index].item);
    }
}

/* Drops the runs put aside that are too far, and puts nearer ones first. Not where all are
 * asked for. */
static INLINE void sort_out(struct tract_search *search, float far)
{
    search->ready = 0;
    for (size_t i = 0; i < search->aside; i++) {
        struct tract_visit visit = search->runs[i];
        size_t place = search->ready;
        search->ready += visit.enter <= far;
        for (; far < INFINITY && visit.enter <= far && place > 0 && visit.enter < search->runs[place - 1].enter;
             place--) {
            search->runs[place] = search->runs[place - 1];
        }
        search->runs[place] = visit;
    }
    search->aside = 0;
    search->next = 0;
    for (size_t i = 0; i < AHEAD; i++) {
        fetch_ready(search, i, far);
    }
}

/* Looks at the next run that is ready. */
static INLINE bool has_hit(struct tract_found *out, struct tract_search *search, float far)
{
    struct tract_visit visit = search->runs[search->next];
    fetch_ready(search, search->next + AHEAD, far);
    search->next++;
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
