/* SPDX-License-Identifier: BSD-3-Clause */
/* Trees of streamlines: they have every segment once, and a walk finds the same runs as a loop over all. */
#include "atlas/tracts/tract_leaf.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/simd/processor.h"
#include "test.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 60000, STREAMLINES = 3000 };

static float points[3 * POINTS];
static uint16_t halves[3 * POINTS];
static uint64_t first[STREAMLINES + 1];

/* Random walks of up to `longest` points, none at all now and then, with steps of up to 2 mm. */
static struct tractogram random_walks(uint64_t *random, size_t streamlines, unsigned longest)
{
    uint64_t count = 0;
    for (size_t s = 0; s < streamlines; s++) {
        uint64_t length = (uint64_t)test_random(random, 0, (double)longest + 1);
        first[s] = count;
        for (uint64_t i = 0; i < length; i++, count++) {
            assert_true(count < POINTS);
            for (int a = 0; a < 3; a++) {
                float before = i ? points[3 * count - 3 + (uint64_t)a] : (float)test_random(random, -60, 60);
                points[3 * count + (uint64_t)a] = i ? before + (float)test_random(random, -1, 1) : before;
            }
        }
    }
    first[streamlines] = count;
    return (struct tractogram){.points = points, .point_count = count, .first = first, .streamline_count = streamlines};
}

/* [point_count] The number of the run that begins at a point. */
static size_t numbers[POINTS];

/* Whether a streamline turns by more than 45 degrees at a point. */
static bool turns_sharply(const struct tractogram *tractogram, uint64_t at)
{
    double before[3];
    double behind[3];
    double point[3][3];
    for (uint64_t i = 0; i < 3; i++) {
        tractogram_point(point[i], tractogram, at + i - 1);
    }
    vec3_sub(before, point[1], point[0]);
    vec3_sub(behind, point[2], point[1]);
    return vec3_normalise(before, before) && vec3_normalise(behind, behind) && vec3_dot(before, behind) < sqrt(0.5);
}

/* Streamlines are cut every 3 segments, or 5 in half precision; or one point before or behind such a place, if they
 * turn sharply there and not at the place itself. */
static bool is_cut(const struct tractogram *tractogram, uint64_t begin, uint64_t end, uint64_t point)
{
    const uint64_t every = tractogram->halves ? 5 : 3;
    for (uint64_t at = begin + every; at + 1 < end; at += every) {
        uint64_t place = at;
        if (!turns_sharply(tractogram, at)) {
            place -= turns_sharply(tractogram, at - 1);
            place += place == at && at + 2 < end && turns_sharply(tractogram, at + 1);
        }
        if (place == point) {
            return true;
        }
    }
    return point == begin || point + 1 == end;
}

/* Every segment is in one run, every single point is a run, and a run reaches from one cut to the next. */
static void check_runs(const struct tractogram *tractogram)
{
    static unsigned char seen[POINTS];
    size_t segments = 0;
    size_t wanted = 0;
    memset(seen, 0, sizeof seen);
    for (size_t r = 0; r < tractogram->tree.run_count; r++) {
        struct tract_run run = tract_run_at(tractogram, r);
        uint64_t begin = tractogram->first[run.streamline];
        uint64_t end = tractogram->first[run.streamline + 1];
        assert_true(run.point >= begin && run.point + run.segments < end);
        for (uint64_t k = 0; k <= run.segments; k++) {
            assert_int_equal(is_cut(tractogram, begin, end, run.point + k), k == 0 || k == run.segments);
        }
        assert_true(run.segments > 0 || begin + 1 == end);
        assert_int_equal(seen[run.point]++, 0);
        numbers[run.point] = r;
        segments += run.segments;
    }
    for (size_t s = 0; s < tractogram->streamline_count; s++) {
        uint64_t count = tractogram->first[s + 1] - tractogram->first[s];
        wanted += count ? count - 1 : 0;
        assert_true(count != 1 || seen[tractogram->first[s]]);
    }
    assert_int_equal(segments, wanted);
}

/* The streamline of a point is the same whether it is found by marks or without them. */
static void check_marks(const struct tractogram *tractogram)
{
    struct tractogram bare = *tractogram;
    bare.tree.marks = NULL;
    for (uint64_t i = 0; i < tractogram->point_count; i++) {
        uint32_t streamline = tractogram_streamline_of(tractogram, i);
        assert_true(first[streamline] <= i && i < first[streamline + 1]);
        assert_int_equal(streamline, tractogram_streamline_of(&bare, i));
    }
}

struct bounds {
    double low[3], high[3];
};

static struct bounds bounds_of(const struct tractogram *tractogram, uint64_t from, uint64_t to)
{
    struct bounds bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint64_t i = from; i < to; i++) {
        double point[3];
        tractogram_point(point, tractogram, i);
        for (int a = 0; a < 3; a++) {
            bounds.low[a] = fmin(bounds.low[a], point[a]);
            bounds.high[a] = fmax(bounds.high[a], point[a]);
        }
    }
    return bounds;
}

/* State of a walk: runs must be visited in order, none twice, and only those that are not outside of `wanted` may
 * be. */
struct walk {
    const struct tractogram *tractogram;
    struct bounds wanted;
    size_t next; /* Number of the run after the last visited one. */
    size_t found;
};

static enum tract_answer compare(void *user, const double low[3], const double high[3])
{
    const struct bounds *wanted = &((const struct walk *)user)->wanted;
    enum tract_answer answer = TRACT_INSIDE;
    for (int a = 0; a < 3; a++) {
        if (high[a] < wanted->low[a] || low[a] > wanted->high[a]) {
            return TRACT_OUTSIDE;
        }
        answer = low[a] < wanted->low[a] || high[a] > wanted->high[a] ? TRACT_PERHAPS : answer;
    }
    return answer;
}

static struct bounds bounds_of_run(const struct tractogram *tractogram, size_t number)
{
    struct tract_run run = tract_run_at(tractogram, number);
    return bounds_of(tractogram, run.point, run.point + run.segments + 1);
}

static enum tract_answer compare_run(struct walk *walk, size_t number)
{
    struct bounds bounds = bounds_of_run(walk->tractogram, number);
    return compare(walk, bounds.low, bounds.high);
}

static double size_of(const struct bounds *bounds)
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += bounds->high[a] - bounds->low[a];
    }
    return sum;
}

/* Compares a run with the wanted box, enlarged by the error of the tree. No box of the tree is larger than that around
 * the run's points, grown as follows. A byte moves each end by at most a step, 1/255 of the leaf's size. So points are
 * no farther from the segment between the ends than the run's size and two steps. That is rounded up by at most 1/31 of
 * the largest such distance in the leaf, which is no more than the leaf's size. */
static enum tract_answer compare_loosely(struct walk *walk, size_t number)
{
    size_t leaf = number / TRACT_LEAF * TRACT_LEAF;
    struct bounds bounds = bounds_of_run(walk->tractogram, number);
    struct bounds around = bounds;
    for (size_t r = leaf; r < leaf + TRACT_LEAF && r < walk->tractogram->tree.run_count; r++) {
        struct bounds other = bounds_of_run(walk->tractogram, r);
        for (int a = 0; a < 3; a++) {
            around.low[a] = fmin(around.low[a], other.low[a]);
            around.high[a] = fmax(around.high[a], other.high[a]);
        }
    }
    double more = size_of(&bounds) + size_of(&around) * (3 / 255.0 + 1.01 / 31) + 1e-5;
    for (int a = 0; a < 3; a++) {
        bounds.low[a] -= more;
        bounds.high[a] += more;
    }
    return compare(walk, bounds.low, bounds.high);
}

static void take(void *user, const struct tract_run *run, bool inside)
{
    struct walk *walk = user;
    size_t number = numbers[run->point];
    struct tract_run same = tract_run_at(walk->tractogram, number);
    assert_true(same.point == run->point && same.segments == run->segments && same.streamline == run->streamline);
    assert_true(number >= walk->next);
    for (; walk->next < number; walk->next++) {
        assert_int_equal(compare_run(walk, walk->next), TRACT_OUTSIDE);
    }
    assert_int_not_equal(compare_loosely(walk, number), TRACT_OUTSIDE);
    assert_true(!inside || compare_run(walk, number) == TRACT_INSIDE);
    walk->next = number + 1;
    walk->found++;
}

/* A walk finds every run that touches the box, and no run that is far from it. Returns the number of runs found. */
static size_t check_walk(const struct tractogram *tractogram, const struct bounds *wanted)
{
    struct walk walk = {.tractogram = tractogram, .wanted = *wanted};
    tract_tree_walk(tractogram, compare, take, &walk);
    for (; walk.next < tractogram->tree.run_count; walk.next++) {
        assert_int_equal(compare_run(&walk, walk.next), TRACT_OUTSIDE);
    }
    return walk.found;
}

static double coordinate_of(const struct tract_leaf *leaf, size_t lane, int end, int axis)
{
    return (double)leaf->low[axis] + (double)leaf->step[axis] * leaf->ends[end][axis][lane];
}

/* Distance of a point from the nearest of 257 points of a lane's segment. It exceeds that from the segment by at most
 * half a step. */
static double distance_from(const struct tract_leaf *leaf, size_t lane, const double point[3], double *step)
{
    double least = INFINITY;
    for (int i = 0; i <= 256; i++) {
        double sum = 0;
        *step = 0;
        for (int a = 0; a < 3; a++) {
            double from = coordinate_of(leaf, lane, 0, a);
            double side = coordinate_of(leaf, lane, 1, a) - from;
            double away = from + i / 256.0 * side - point[a];
            sum += away * away;
            *step += side * side;
        }
        least = fmin(least, sqrt(sum));
    }
    *step = sqrt(*step) / 256;
    return least;
}

/* Points of a run are no farther than its thickness from the segment between its ends. That segment ends no farther
 * than the thickness and the rounding from the run's own ends. */
static void check_capsules(const struct tractogram *tractogram)
{
    for (size_t r = 0; r < tractogram->tree.run_count; r++) {
        const struct tract_leaf *leaf = &tractogram->tree.leaves[r / TRACT_LEAF];
        const size_t lane = r % TRACT_LEAF;
        const struct tract_run run = tract_run_at(tractogram, r);
        const double thickness = (double)leaf->thickness * (leaf->bend[lane] >> TRACT_SEGMENTS_BITS);
        for (uint32_t k = 0; k <= run.segments; k++) {
            double step;
            double point[3];
            double off = 0;
            tractogram_point(point, tractogram, run.point + k);
            assert_true(distance_from(leaf, lane, point, &step) <= thickness + step / 2);
            for (int a = 0; a < 3; a++) {
                double way = coordinate_of(leaf, lane, k > 0, a) - point[a];
                off += way * way;
            }
            assert_true((k > 0 && k < run.segments) || sqrt(off) <= thickness + 1.01 * tract_leaf_rounding(leaf));
        }
    }
}

/* The two cuts of an item's box along a diagonal; returns by how much a cut may be too small. */
static double find_cuts(double cut[2], const struct tract_node *node, size_t lane, int d)
{
    static const int diagonals[4][3] = {{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
    double length = 0;
    cut[0] = 0;
    for (int a = 0; a < 3; a++) {
        double low = (double)node->low[a][lane];
        double high = (double)node->high[a][lane];
        assert_int_equal(tract_diagonal(d, a), diagonals[d][a]);
        cut[0] += fmin(diagonals[d][a] * low, diagonals[d][a] * high);
        length += high - low;
    }
    cut[1] = cut[0] + length - length / 256 * node->cut[1][d][lane];
    cut[0] += length / 256 * node->cut[0][d][lane];
    return length / 256;
}

/* All points of an item's runs are between its cuts; in a leaf they reach near to both cuts. */
static void check_item(const struct tractogram *tractogram, const struct tract_node *node, unsigned level, size_t item)
{
    size_t begin = (item << TRACT_WIDTH_BITS * level) * TRACT_LEAF;
    size_t end = begin + ((size_t)TRACT_LEAF << TRACT_WIDTH_BITS * level);
    for (int d = 0; d < 4; d++) {
        double cut[2];
        double found[2] = {INFINITY, -INFINITY};
        double step = find_cuts(cut, node, item % TRACT_WIDTH, d);
        for (size_t r = begin; r < end && r < tractogram->tree.run_count; r++) {
            struct tract_run run = tract_run_at(tractogram, r);
            for (uint64_t k = 0; k <= run.segments; k++) {
                double point[3];
                tractogram_point(point, tractogram, run.point + k);
                double sum = point[0] + point[1] + point[2] - (d ? 2 * point[d - 1] : 0);
                found[0] = fmin(found[0], sum);
                found[1] = fmax(found[1], sum);
            }
        }
        assert_true(found[0] >= cut[0] - 1e-9 && found[1] <= cut[1] + 1e-9);
        assert_true(level > 0 || (found[0] <= cut[0] + step + 1e-9 && found[1] >= cut[1] - step - 1e-9));
    }
}

static void check_diagonals(const struct tractogram *tractogram)
{
    struct tract_levels levels = tract_levels_of(tractogram->tree.run_count);
    for (unsigned level = 0; level < levels.count; level++) {
        for (size_t item = 0; item < levels.items[level]; item++) {
            check_item(tractogram, &tractogram->tree.nodes[levels.first[level] + item / TRACT_WIDTH], level, item);
        }
    }
}

static void check_walks(uint64_t *random, const struct tractogram *tractogram)
{
    static const struct bounds all = {{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
    assert_int_equal(check_walk(tractogram, &all), tractogram->tree.run_count);
    for (int i = 0; i < 20; i++) {
        struct bounds wanted;
        for (int a = 0; a < 3; a++) {
            wanted.low[a] = test_random(random, -60, 60);
            wanted.high[a] = wanted.low[a] + test_random(random, 0, 60);
        }
        check_walk(tractogram, &wanted);
    }
}

/* Trees of one run, of up to two levels, with nodes that are full to the last lane, and with many levels. */
static void a_walk_finds_what_a_loop_finds(void **state)
{
    (void)state;
    static const unsigned counts[][2] = {{0, 1},   {1, 0},   {1, 1},   {3, 2},     {8, 17},    {9, 17},
                                         {64, 30}, {65, 30}, {511, 3}, {520, 100}, {3000, 30}, {60, 900}};
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        struct tractogram tractogram = random_walks(&random, counts[i][0], counts[i][1]);
        assert_ok(tractogram_grow_tree(&tractogram));
        struct bounds bounds = bounds_of(&tractogram, 0, tractogram.point_count);
        for (int a = 0; a < 3; a++) {
            assert_true(tractogram.low[a] == bounds.low[a] && tractogram.high[a] == bounds.high[a]);
        }
        check_runs(&tractogram);
        check_marks(&tractogram);
        check_capsules(&tractogram);
        check_diagonals(&tractogram);
        check_walks(&random, &tractogram);
        tract_tree_finish(&tractogram.tree);
    }
}

/* All points are equal, or all but one that is far away: no median separates them. */
static void equal_points_make_a_tree(void **state)
{
    (void)state;
    uint64_t random = 2;
    for (int far = 0; far < 2; far++) {
        struct tractogram tractogram = random_walks(&random, 2000, 20);
        memset(points, 0, sizeof points);
        points[3 * 77 + 1] = far ? 1e9F : 0;
        assert_ok(tractogram_grow_tree(&tractogram));
        assert_true(tractogram.high[1] == (far ? 1e9 : 0.0));
        check_runs(&tractogram);
        check_marks(&tractogram);
        check_capsules(&tractogram);
        check_diagonals(&tractogram);
        check_walks(&random, &tractogram);
        tract_tree_finish(&tractogram.tree);
    }
}

/* A copy in half precision: points of one octave, as near as half precision comes. */
static struct tractogram as_halves(uint64_t *random, const struct tractogram *tractogram)
{
    struct tractogram out = *tractogram;
    for (uint64_t i = 0; i < 3 * out.point_count; i++) {
        halves[i] = (uint16_t)test_random(random, 0x4000, 0x5000);
    }
    out.points = NULL;
    out.halves = halves;
    return out;
}

/* The same points give the same tree. In half precision its runs are longer, and it has every segment, too. */
static void a_tree_follows_from_the_points(void **state)
{
    (void)state;
    uint64_t random = 3;
    const struct tractogram floats = random_walks(&random, 500, 40);
    const struct tractogram both[] = {floats, as_halves(&random, &floats)};
    for (int i = 0; i < 2; i++) {
        struct tractogram once = both[i];
        struct tractogram again = both[i];
        assert_ok(tractogram_grow_tree(&once));
        assert_ok(tractogram_grow_tree(&again));
        check_runs(&once);
        check_marks(&once);
        check_capsules(&once);
        check_walks(&random, &once);
        assert_int_equal(once.tree.node_count, again.tree.node_count);
        assert_int_equal(once.tree.run_count, again.tree.run_count);
        assert_memory_equal(once.tree.nodes, again.tree.nodes, once.tree.node_count * sizeof(struct tract_node));
        assert_memory_equal(once.tree.leaves, again.tree.leaves,
                            tract_leaf_count(once.tree.run_count) * sizeof(struct tract_leaf));
        tract_tree_finish(&once.tree);
        tract_tree_finish(&again.tree);
    }
}

/* Walks of up to 20 mm in a cube of 120 mm: 300 leaves have about a quarter of the cube's edge each. A point so far
 * away that all others are one place beside it does not change that. Only the lowest node above it, with 16 leaves, has
 * runs from anywhere. */
static void a_point_far_away_spoils_no_order(void **state)
{
    (void)state;
    uint64_t random = 5;
    struct tractogram tractogram = random_walks(&random, 2900, 20);
    size_t large = 0;
    points[0] = 1e9F;
    assert_ok(tractogram_grow_tree(&tractogram));
    assert_in_range(tract_leaf_count(tractogram.tree.run_count), 250, 500);
    for (size_t i = 0; i < tract_leaf_count(tractogram.tree.run_count); i++) {
        const struct tract_leaf *leaf = &tractogram.tree.leaves[i];
        large += 255 * leaf->step[0] > 60 || 255 * leaf->step[1] > 60 || 255 * leaf->step[2] > 60;
    }
    assert_in_range(large, 1, 16);
    tract_tree_finish(&tractogram.tree);
}

static void check_size(struct tractogram *tractogram, size_t runs, size_t leaves, size_t nodes)
{
    assert_ok(tractogram_grow_tree(tractogram));
    assert_int_equal(tractogram->tree.run_count, runs);
    assert_int_equal(tract_leaf_count(runs), leaves);
    assert_int_equal(tractogram->tree.node_count, nodes);
    size_t bytes = leaves * sizeof(struct tract_leaf) + nodes * sizeof(struct tract_node);
    bytes += tract_mark_count(tractogram->point_count) * sizeof *tractogram->tree.marks;
    size_t point = tractogram->points ? 3 * sizeof(float) : 3 * sizeof(uint16_t);
    assert_true(2 * bytes <= point * tractogram->point_count);
    tract_tree_finish(&tractogram->tree);
}

/* Streamlines of 100 points have 33 runs, or 20 in half precision. The tree may take half as much memory as the
 * points. */
static void a_tree_is_small(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    for (size_t s = 0; s <= COUNT; s++) {
        first[s] = 100 * s;
    }
    struct tractogram tractogram = {.points = points, .first = first, .streamline_count = COUNT};
    tractogram.point_count = first[COUNT];
    check_size(&tractogram, 33 * (size_t)COUNT, 619, 39 + 3 + 1);
    tractogram.points = NULL;
    tractogram.halves = halves;
    check_size(&tractogram, 20 * (size_t)COUNT, 375, 24 + 2 + 1);
}

/* An arc of height 1 is no farther than 0.5 from a segment at half its height. A streamline that turns round beside a
 * cut is cut at the turn, and its runs are straight. */
static void runs_are_slim(void **state)
{
    (void)state;
    static const float arc[] = {0, 0, 0, 1, 1, 0, 2, 1, 0, 3, 0, 0};
    static const float corners[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 2, 2, 0, 2, 3, 0, 2, 4, 0, 2, 5, 0, 2, 5, 1};
    struct tractogram tractogram = {.points = points, .first = first, .streamline_count = 1};
    memcpy(points, arc, sizeof arc);
    first[1] = tractogram.point_count = 4;
    assert_ok(tractogram_grow_tree(&tractogram));
    const struct tract_leaf *leaf = tractogram.tree.leaves;
    double thickness = (double)leaf->thickness * (leaf->bend[0] >> TRACT_SEGMENTS_BITS);
    assert_true(thickness >= 0.5 && thickness < 0.51);
    tract_tree_finish(&tractogram.tree);
    memcpy(points, corners, sizeof corners);
    first[1] = tractogram.point_count = 9;
    assert_ok(tractogram_grow_tree(&tractogram));
    check_runs(&tractogram);
    assert_int_equal(tractogram.tree.run_count, 3);
    leaf = tractogram.tree.leaves;
    assert_true((double)leaf->thickness * 31 < 0.04);
    tract_tree_finish(&tractogram.tree);
}

/* Enough streamlines for three threads, of 0 to 6 points; the first ones have more, so that threads have unequal work.
 * With one processor there is one thread, whose tree any number of threads must make. */
static void threads_make_the_same_tree(void **state)
{
    (void)state;
    enum { MANY = 50000 };
    uint64_t random = 6;
    cpu_set_t all;
    cpu_set_t one;
    uint64_t *begins = memory_raw(MANY + 1, sizeof *begins);
    float *at = memory_raw((size_t)MANY * 16, 3 * sizeof *at);
    assert_true(begins && at);
    uint64_t count = 0;
    for (size_t s = 0; s <= MANY; s++) {
        begins[s] = count;
        count += s < MANY ? (uint64_t)test_random(&random, 0, s < 9000 ? 16 : 7) : 0;
    }
    for (uint64_t i = 0; i < 3 * count; i++) {
        at[i] = (float)test_random(&random, -60, 60);
    }
    struct tractogram together = {
        .points = at, .point_count = count, .first = begins, .streamline_count = MANY, .radius = 1};
    struct tractogram alone = together;
    assert_ok(tractogram_grow_tree(&together));
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    for (size_t cpu = 0; cpu < CPU_SETSIZE && !CPU_COUNT(&one); cpu++) {
        if (CPU_ISSET(cpu, &all)) {
            CPU_SET(cpu, &one);
        }
    }
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_ok(tractogram_grow_tree(&alone));
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_int_equal(together.tree.run_count, alone.tree.run_count);
    assert_memory_equal(together.tree.nodes, alone.tree.nodes, alone.tree.node_count * sizeof(struct tract_node));
    assert_memory_equal(together.tree.leaves, alone.tree.leaves,
                        tract_leaf_count(alone.tree.run_count) * sizeof(struct tract_leaf));
    assert_memory_equal(together.tree.lengths, alone.tree.lengths, MANY * sizeof(double));
    assert_memory_equal(together.tree.marks, alone.tree.marks, tract_mark_count(count) * sizeof(uint32_t));
    assert_memory_equal(together.low, alone.low, sizeof alone.low);
    assert_memory_equal(together.high, alone.high, sizeof alone.high);
    for (uint32_t s = 0; s < MANY; s += 777) { /* the kept runs are those that were summed */
        struct tractogram bare = alone;
        bare.tree.lengths = NULL;
        assert_true(tractogram_length(&alone, s) == tractogram_length(&bare, s));
    }
    tract_tree_finish(&together.tree);
    tract_tree_finish(&alone.tree);
    memory_free(begins);
    memory_free(at);
}

#if defined(__x86_64__)
static void fill_at_random(float *out, size_t count, uint64_t *random)
{
    for (size_t i = 0; i < count; i++) {
        out[i] = (float)floor(test_random(random, -9, 9)) / 3; /* so that points and distances are equal at times */
    }
}

static void kernels_give_the_same_bits(void **state)
{
    enum { TRIALS = 500 };
    (void)state;
    uint64_t random = 6;
    if (!processor_has_avx2()) {
        skip();
    }
    for (uint32_t i = 0; i < TRIALS; i++) {
        struct tract_leaf leaves[2] = {0};
        struct hull hulls[2];
        struct tract_runs runs[2] = {{.longest = 1 + i % TRACT_RUN}};
        fill_at_random(runs[0].points[0][0], sizeof runs[0].points / sizeof(float), &random);
        fill_at_random(runs[0].last[0], sizeof runs[0].last / sizeof(float), &random);
        runs[1] = runs[0];
        tract_leaf_set_plain(&leaves[0], &hulls[0], &runs[0]);
        tract_leaf_set_avx2(&leaves[1], &hulls[1], &runs[1]);
        assert_memory_equal(&leaves[0], &leaves[1], sizeof leaves[0]);
        assert_memory_equal(&hulls[0], &hulls[1], sizeof hulls[0]);
        assert_memory_equal(runs[0].bends, runs[1].bends, sizeof runs[0].bends);
    }
}
#endif

static void too_many_points_are_refused(void **state)
{
    (void)state;
    struct tractogram tractogram = {.points = points, .first = first, .point_count = (uint64_t)UINT32_MAX + 1};
    assert_fails(tractogram_grow_tree(&tractogram), CONUS_ERROR_DATA);
    assert_null(tractogram.tree.leaves);
}

static conus_status grow(void *data)
{
    struct tractogram tractogram = *(const struct tractogram *)data;
    conus_status status = tractogram_grow_tree(&tractogram);
    tract_tree_finish(&tractogram.tree);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    uint64_t random = 4;
    struct tractogram tractogram = random_walks(&random, 100, 40);
    test_every_allocation(grow, &tractogram);
}

TEST_GROUP(tract_tree)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_walk_finds_what_a_loop_finds),
        cmocka_unit_test(equal_points_make_a_tree),
        cmocka_unit_test(a_tree_follows_from_the_points),
        cmocka_unit_test(a_tree_is_small),
        cmocka_unit_test(a_point_far_away_spoils_no_order),
        cmocka_unit_test(threads_make_the_same_tree),
        cmocka_unit_test(too_many_points_are_refused),
        cmocka_unit_test(runs_are_slim),
        cmocka_unit_test(every_allocation_may_fail),
#if defined(__x86_64__)
        cmocka_unit_test(kernels_give_the_same_bits),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
