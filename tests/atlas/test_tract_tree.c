/* SPDX-License-Identifier: BSD-3-Clause */
/* Trees of streamlines: they have every segment once, and a walk finds what a loop over all runs finds. */
#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "base/memory.h"
#include "test.h"

#include <math.h>
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

static void finish_tree(struct tractogram *tractogram)
{
    memory_free(tractogram->tree.nodes);
    memory_free(tractogram->tree.runs);
    tractogram->tree = (struct tract_tree){0};
}

/* ---- Runs ------------------------------------------------------------------------------------------------------- */

/* Every segment is in one run, every single point is one, and a run begins 16 segments after that before it. */
static void check_runs(const struct tractogram *tractogram)
{
    static unsigned char seen[POINTS];
    size_t segments = 0;
    size_t wanted = 0;
    memset(seen, 0, sizeof seen);
    for (size_t r = 0; r < tractogram->tree.run_count; r++) {
        const struct tract_run *run = &tractogram->tree.runs[r];
        uint64_t begin = tractogram->first[run->streamline];
        uint64_t end = tractogram->first[run->streamline + 1];
        assert_true(run->point >= begin && run->point + run->segments < end);
        assert_int_equal((run->point - begin) % TRACT_RUN, 0);
        assert_true(run->segments == TRACT_RUN || run->point + run->segments + 1 == end);
        assert_true(run->segments > 0 || begin + 1 == end);
        assert_int_equal(seen[run->point]++, 0);
        segments += run->segments;
    }
    for (size_t s = 0; s < tractogram->streamline_count; s++) {
        uint64_t count = tractogram->first[s + 1] - tractogram->first[s];
        wanted += count ? count - 1 : 0;
        assert_true(count != 1 || seen[tractogram->first[s]]);
    }
    assert_int_equal(segments, wanted);
}

/* ---- Walks ------------------------------------------------------------------------------------------------------ */

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

/* What is visited has to be, as often as it has to be, and in order. */
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

static enum tract_answer compare_run(struct walk *walk, size_t number)
{
    const struct tract_run *run = &walk->tractogram->tree.runs[number];
    struct bounds bounds = bounds_of(walk->tractogram, run->point, run->point + run->segments + 1);
    return compare(walk, bounds.low, bounds.high);
}

/* The box round the run's ends, larger by how far its points are at most from its first one: no box is larger. */
static enum tract_answer compare_loosely(struct walk *walk, size_t number)
{
    const struct tract_run *run = &walk->tractogram->tree.runs[number];
    struct bounds bounds = bounds_of(walk->tractogram, run->point, run->point + run->segments + 1);
    double bend = 0;
    for (int a = 0; a < 3; a++) {
        bend += bounds.high[a] - bounds.low[a];
    }
    for (int a = 0; a < 3; a++) {
        bounds.low[a] -= bend;
        bounds.high[a] += bend;
    }
    return compare(walk, bounds.low, bounds.high);
}

static void take(void *user, const struct tract_run *run, bool inside)
{
    struct walk *walk = user;
    size_t number = (size_t)(run - walk->tractogram->tree.runs);
    assert_true(number >= walk->next);
    for (; walk->next < number; walk->next++) {
        assert_int_equal(compare_run(walk, walk->next), TRACT_OUTSIDE);
    }
    assert_int_not_equal(compare_loosely(walk, number), TRACT_OUTSIDE);
    assert_true(!inside || compare_run(walk, number) == TRACT_INSIDE);
    walk->next = number + 1;
    walk->found++;
}

/* What touches a box is found, and nothing else but runs that are near to it. Returns how many are found. */
static size_t check_walk(const struct tractogram *tractogram, const struct bounds *wanted)
{
    struct walk walk = {.tractogram = tractogram, .wanted = *wanted};
    tract_tree_walk(&tractogram->tree, compare, take, &walk);
    for (; walk.next < tractogram->tree.run_count; walk.next++) {
        assert_int_equal(compare_run(&walk, walk.next), TRACT_OUTSIDE);
    }
    return walk.found;
}

/* ---- Capsules --------------------------------------------------------------------------------------------------- */

/* Of a point from 257 points of a lane's segment; that is at most half a step more than from the segment. */
static double distance_from(const struct tract_node *node, size_t lane, const double point[3], double *step)
{
    double least = INFINITY;
    for (int i = 0; i <= 256; i++) {
        double sum = 0;
        *step = 0;
        for (int a = 0; a < 3; a++) {
            double side = (double)node->b[a][lane] - (double)node->a[a][lane];
            double away = (double)node->a[a][lane] + i / 256.0 * side - point[a];
            sum += away * away;
            *step += side * side;
        }
        least = fmin(least, sqrt(sum));
    }
    *step = sqrt(*step) / 256;
    return least;
}

/* Of every second point from the line between its neighbours, by the height of the triangle: twice its area (Heron's
 * formula) divided by its base; the sides are shorter where the height is outside. */
static void check_fine(const struct tractogram *tractogram, const struct tract_node *node, size_t lane,
                       const struct tract_run *run)
{
    for (uint32_t k = 2; k <= run->segments; k += 2) {
        double p[3][3];
        double side[3];
        for (uint64_t i = 0; i < 3; i++) {
            tractogram_point(p[i], tractogram, run->point + k - i);
        }
        for (int i = 0; i < 3; i++) {
            const double *q = p[(i + 1) % 3];
            side[i] = hypot(hypot(p[i][0] - q[0], p[i][1] - q[1]), p[i][2] - q[2]);
        }
        double half = (side[0] + side[1] + side[2]) / 2;
        double area = sqrt(fmax(half * (half - side[0]) * (half - side[1]) * (half - side[2]), 0));
        double height = side[2] > 0 ? 2 * area / side[2] : 0;
        assert_true((double)node->fine[lane] >= height - 1e-5);
    }
}

/* Runs are in the capsules of level 0. */
static void check_capsules(const struct tractogram *tractogram)
{
    for (size_t r = 0; r < tractogram->tree.run_count; r++) {
        const struct tract_node *node = &tractogram->tree.nodes[r / TRACT_WIDTH];
        const struct tract_run *run = &tractogram->tree.runs[r];
        check_fine(tractogram, node, r % TRACT_WIDTH, run);
        for (uint32_t k = 0; k <= run->segments; k++) {
            double step;
            double point[3];
            tractogram_point(point, tractogram, run->point + k);
            double away = distance_from(node, r % TRACT_WIDTH, point, &step);
            assert_true(away <= (double)node->thickness[r % TRACT_WIDTH] + step / 2);
        }
    }
}

/* ---- Trees ------------------------------------------------------------------------------------------------------ */

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

/* ---- Tests ------------------------------------------------------------------------------------------------------ */

/* Trees of up to two levels and one run, of nodes that are full to the last lane, and of many levels. */
static void a_walk_finds_what_a_loop_finds(void **state)
{
    (void)state;
    static const unsigned counts[][2] = {{0, 1},   {1, 0},   {1, 1},   {3, 2},     {8, 17},   {9, 17},
                                         {64, 30}, {65, 30}, {511, 3}, {520, 100}, {3000, 30}};
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        struct tractogram tractogram = random_walks(&random, counts[i][0], counts[i][1]);
        assert_ok(tractogram_grow_tree(&tractogram));
        struct bounds bounds = bounds_of(&tractogram, 0, tractogram.point_count);
        for (int a = 0; a < 3; a++) {
            assert_true(tractogram.low[a] == bounds.low[a] && tractogram.high[a] == bounds.high[a]);
        }
        check_runs(&tractogram);
        check_capsules(&tractogram);
        check_walks(&random, &tractogram);
        finish_tree(&tractogram);
    }
}

/* All points are one, or all but one that is far away: no median separates them. */
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
        check_capsules(&tractogram);
        check_walks(&random, &tractogram);
        finish_tree(&tractogram);
    }
}

/* The same points give the same tree, in half precision, too. */
static void a_tree_follows_from_the_points(void **state)
{
    (void)state;
    uint64_t random = 3;
    struct tractogram once = random_walks(&random, 500, 40);
    for (uint64_t i = 0; i < 3 * once.point_count; i++) {
        halves[i] = (uint16_t)test_random(&random, 0x4000, 0x5000);
        points[i] = (float)tract_from_half(halves[i]);
    }
    struct tractogram again = once;
    again.points = NULL;
    again.halves = halves;
    assert_ok(tractogram_grow_tree(&once));
    assert_ok(tractogram_grow_tree(&again));
    assert_int_equal(once.tree.node_count, again.tree.node_count);
    assert_int_equal(once.tree.run_count, again.tree.run_count);
    assert_memory_equal(once.tree.nodes, again.tree.nodes, once.tree.node_count * sizeof(struct tract_node));
    assert_memory_equal(once.tree.runs, again.tree.runs, once.tree.run_count * sizeof(struct tract_run));
    finish_tree(&once);
    finish_tree(&again);
}

/* Streamlines of 100 points have 7 runs. Half of the 12 bytes of a point are allowed. */
static void a_tree_is_small(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    for (size_t s = 0; s <= COUNT; s++) {
        first[s] = 100 * s;
    }
    struct tractogram tractogram = {.points = points, .first = first, .streamline_count = COUNT};
    tractogram.point_count = first[COUNT];
    assert_ok(tractogram_grow_tree(&tractogram));
    assert_int_equal(tractogram.tree.run_count, 7 * COUNT);
    assert_int_equal(tractogram.tree.node_count, 525 + 66 + 9 + 2 + 1);
    size_t bytes = tractogram.tree.run_count * sizeof(struct tract_run);
    bytes += tractogram.tree.node_count * sizeof(struct tract_node);
    assert_true(bytes <= 6 * (size_t)tractogram.point_count);
    finish_tree(&tractogram);
}

static conus_status grow(void *data)
{
    struct tractogram tractogram = *(const struct tractogram *)data;
    conus_status status = tractogram_grow_tree(&tractogram);
    finish_tree(&tractogram);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    uint64_t random = 4;
    struct tractogram tractogram = random_walks(&random, 100, 40);
    test_every_allocation(grow, &tractogram);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_walk_finds_what_a_loop_finds), cmocka_unit_test(equal_points_make_a_tree),
        cmocka_unit_test(a_tree_follows_from_the_points), cmocka_unit_test(a_tree_is_small),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
