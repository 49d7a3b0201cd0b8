/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A kernel of the search: the including file says how many LANES there are, 4 or 8, and what the KERNEL is
 * called. */
#include "base/lanes.h"
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
    struct ray ray = {.slack = all(search->slack), .limit = all(limit)};
    for (int a = 0; a < 3; a++) {
        ray.origin[a] = all(search->origin[a]);
        ray.direction[a] = all(search->direction[a]);
    }
    return ray;
}

/* ---- Boxes ------------------------------------------------------------------------------------------------------ */

/* Bit l: the ray may be in the box of lane l, grown by the radius, at the limit or before; enter[l] is from where. */
static INLINE unsigned boxes_hit(float enter[TRACT_WIDTH], const struct tract_search *search,
                                 const struct tract_node *node, float limit)
{
    float grown = search->radius + search->slack;
    unsigned bits = 0;
    for (int first = 0; first < TRACT_WIDTH; first += LANES) {
        singles in = all(-search->slack);
        singles out = all(limit);
        for (int a = 0; a < 3; a++) {
            bool back = search->inverse[a] < 0;
            singles near = singles_at((back ? node->b[a] : node->a[a]) + first);
            singles far = singles_at((back ? node->a[a] : node->b[a]) + first);
            singles inverse = all(search->inverse[a]);
            float more = back ? -grown : grown;
            in = larger(in, (near - all(search->origin[a] + more)) * inverse);
            out = smaller(out, (far - all(search->origin[a] - more)) * inverse);
        }
        store_singles(enter + first, in);
        bits |= bits_of(at_most(in, out)) << first;
    }
    return bits;
}

/* ---- Capsules --------------------------------------------------------------------------------------------------- */

/* Whether the ray may be in the capsules of a radius round the segments from a to b, and from where on. Seen along the
 * ray, a segment is one of a plane, a + h e, and the ray is the plane's origin. The ray is only near to the capsule's
 * axis where that is no farther than the radius from it in the plane: for h within radius / |e| of the nearest. A
 * segment that is shorter than the slack there counts as if it were as long: then all of h is near. */
static INLINE truths capsules_hit(singles *enter, const struct ray *ray, const singles a[3], const singles b[3],
                                  singles radius)
{
    singles from[3], e[3], away[3], to[3];
    for (int k = 0; k < 3; k++) {
        from[k] = a[k] - ray->origin[k];
        to[k] = b[k] - ray->origin[k];
    }
    singles depth = dot(from, ray->direction);
    singles deeper = dot(to, ray->direction) - depth;
    singles last = depth + deeper;
    for (int k = 0; k < 3; k++) {
        from[k] -= depth * ray->direction[k];
        e[k] = (to[k] - last * ray->direction[k]) - from[k];
    }
    singles inverse = all(1) / root(larger(dot(e, e), ray->slack * ray->slack));
    singles nearest = -dot(from, e) * inverse * inverse;
    singles half = (radius + ray->slack + ray->slack) * inverse;
    singles h = larger(all(0), smaller(all(1), nearest));
    singles low = larger(all(0), smaller(all(1), nearest - half));
    singles high = larger(all(0), smaller(all(1), nearest + half));
    for (int k = 0; k < 3; k++) {
        away[k] = from[k] + h * e[k];
    }
    singles one = depth + low * deeper;
    singles other = depth + high * deeper;
    *enter = smaller(one, other) - radius;
    return both_truths(at_most(dot(away, away), radius * radius),
                       both_truths(at_most(-ray->slack, larger(one, other) + radius), at_most(*enter, ray->limit)));
}

static INLINE unsigned runs_hit(float enter[TRACT_WIDTH], const struct tract_search *search,
                                const struct tract_node *node, float limit)
{
    struct ray ray = ray_of(search, limit);
    singles radius = all(search->radius + search->slack);
    unsigned bits = 0;
    for (int first = 0; first < TRACT_WIDTH; first += LANES) {
        singles a[3], b[3], in;
        for (int k = 0; k < 3; k++) {
            a[k] = singles_at(node->a[k] + first);
            b[k] = singles_at(node->b[k] + first);
        }
        truths hit = capsules_hit(&in, &ray, a, b, radius + singles_at(node->thickness + first));
        store_singles(enter + first, in);
        bits |= bits_of(hit) << first;
    }
    return bits;
}

/* ---- Segments --------------------------------------------------------------------------------------------------- */

enum { PAIRS = TRACT_RUN / 2 };

/* Every second point of a run, axis by axis; the last one is repeated. */
static INLINE void take_points(float out[3][PAIRS + 1], const struct tractogram *tractogram,
                               const struct tract_run *run)
{
    for (uint32_t k = 0; k <= PAIRS; k++) {
        uint64_t index = 3 * (run->point + (2 * k < run->segments ? 2 * k : run->segments));
        for (uint64_t a = 0; a < 3; a++) {
            out[a][k] = tractogram->points ? tractogram->points[index + a]
                                           : (float)tract_from_half(tractogram->halves[index + a]);
        }
    }
}

/* Bits of both segments of the pairs that the ray may hit. */
static INLINE uint32_t segments_hit(const struct tract_search *search, size_t number, float limit)
{
    const struct tract_run *run = &search->tractogram->tree.runs[number];
    float fine = search->tractogram->tree.nodes[number / TRACT_WIDTH].fine[number % TRACT_WIDTH];
    struct ray ray = ray_of(search, limit);
    uint32_t bits = 0;
    float points[3][PAIRS + 1];
    take_points(points, search->tractogram, run);
    for (uint32_t first = 0; first < PAIRS; first += LANES) {
        singles a[3], b[3], in;
        for (int k = 0; k < 3; k++) {
            a[k] = singles_at(points[k] + first);
            b[k] = singles_at(points[k] + first + 1);
        }
        unsigned hit = bits_of(capsules_hit(&in, &ray, a, b, all(search->radius + search->slack + fine)));
        for (uint32_t pair = first; hit; hit >>= 1, pair++) {
            bits |= (hit & 1 ? 3U : 0U) << 2 * pair;
        }
    }
    uint32_t count = run->segments ? run->segments : 1;
    return bits & (0xffffffffU >> (32 - count));
}

/* ---- The search ------------------------------------------------------------------------------------------------- */

enum { LINE = 64 };

static INLINE void fetch_points(const struct tractogram *tractogram, const struct tract_run *run)
{
    const char *from = tractogram->points ? (const char *)(tractogram->points + 3 * run->point)
                                          : (const char *)(tractogram->halves + 3 * run->point);
    size_t size = 3 * (run->segments + 1) * (tractogram->points ? sizeof(float) : sizeof(uint16_t));
    for (size_t at = 0; at < size; at += LINE) {
        __builtin_prefetch(from + at);
    }
}

/* What is read of an item when its turn comes, or the processor would wait for it then: points of a run; else its node,
 * and the runs below it. */
static INLINE void fetch(const struct tract_search *search, uint32_t level, size_t item)
{
    const struct tract_tree *tree = &search->tractogram->tree;
    if (level == 0) {
        fetch_points(search->tractogram, &tree->runs[item]);
        return;
    }
    const char *node = (const char *)&tree->nodes[search->levels.first[level - 1] + item];
    for (size_t at = 0; at < sizeof(struct tract_node); at += LINE) {
        __builtin_prefetch(node + at);
    }
    size_t end = (item + 1) * TRACT_WIDTH < tree->run_count ? (item + 1) * TRACT_WIDTH : tree->run_count;
    for (size_t run = item * TRACT_WIDTH; level == 1 && run < end; run += LINE / sizeof *tree->runs) {
        __builtin_prefetch(&tree->runs[run]);
    }
}

/* Lets the items of a node that the ray may hit wait, the nearest one last, which comes first. */
static INLINE void let_wait(struct tract_search *search, const struct tract_visit *visit, float limit)
{
    uint32_t level = visit->level - 1;
    size_t first = visit->item * TRACT_WIDTH;
    size_t left = search->levels.items[level] - first;
    const struct tract_node *node = &search->tractogram->tree.nodes[search->levels.first[level] + visit->item];
    float enter[TRACT_WIDTH];
    unsigned bits = level ? boxes_hit(enter, search, node, limit) : runs_hit(enter, search, node, limit);
    bits &= left < TRACT_WIDTH ? (1U << left) - 1 : 0xffU;
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

tract_search_next KERNEL;

bool KERNEL(struct tract_found *out, struct tract_search *search, double limit)
{
    float far = (float)((limit - search->start) * (1 + TRACT_SLACK)) + search->slack;
    while (search->waiting) {
        struct tract_visit visit = search->visits[--search->waiting];
        if (visit.enter > far) {
            continue;
        }
        if (visit.level) {
            let_wait(search, &visit, far);
            continue;
        }
        out->run = &search->tractogram->tree.runs[visit.item];
        out->segments = segments_hit(search, visit.item, far);
        if (out->segments) {
            return true;
        }
    }
    return false;
}
