/* SPDX-License-Identifier: BSD-3-Clause */
/* Tractograms: memory, checks, lengths, and the traversal of the tree of streamlines. */
#include "atlas/tracts/tractogram.h"

#include "atlas/tracts/tract_node.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "base/threads.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

void tract_tree_finish(struct tract_tree *tree)
{
    memory_free(tree->nodes);
    memory_free(tree->leaves);
    memory_free(tree->lengths);
    memory_free(tree->marks);
    *tree = (struct tract_tree){0};
}

size_t tract_leaf_count(size_t run_count)
{
    return run_count / TRACT_LEAF + (run_count % TRACT_LEAF != 0);
}

size_t tract_mark_count(uint64_t point_count)
{
    return (size_t)(point_count / TRACT_MARK + (point_count % TRACT_MARK != 0));
}

struct tract_levels tract_levels_of(size_t run_count)
{
    struct tract_levels levels = {0};
    for (size_t items = tract_leaf_count(run_count); items > 0 && (items > 1 || levels.count == 0);) {
        levels.items[levels.count] = items;
        items = (items + TRACT_WIDTH - 1) / TRACT_WIDTH;
        levels.first[levels.count++] = levels.node_count;
        levels.node_count += items;
    }
    return levels;
}

void tractogram_finish(struct tractogram *tractogram)
{
    if (!tractogram->has_borrowed_points) {
        memory_free(tractogram->points);
        memory_free(tractogram->halves);
        tract_tree_finish(&tractogram->tree);
    }
    if (!tractogram->is_borrowed) {
        memory_free(tractogram->first);
        for (size_t i = 0; i < tractogram->scalar_count; i++) {
            memory_free(tractogram->scalars[i].values);
        }
        for (size_t i = 0; i < tractogram->group_count; i++) {
            memory_free(tractogram->groups[i].members);
        }
    }
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        memory_free(tractogram->scalars[i].name);
    }
    for (size_t i = 0; i < tractogram->group_count; i++) {
        memory_free(tractogram->groups[i].name);
    }
    memory_free(tractogram->scalars);
    memory_free(tractogram->groups);
    memory_free(tractogram->path);
    file_sums_finish(&tractogram->files);
    *tractogram = (struct tractogram){0};
}

void tractogram_from_lps(struct tractogram *tractogram)
{
    for (uint64_t i = 0; i < 3 * tractogram->point_count; i += 3) {
        for (uint64_t a = i; a < i + 2; a++) {
            if (tractogram->points) {
                tractogram->points[a] = -tractogram->points[a];
            } else {
                tractogram->halves[a] ^= 0x8000;
            }
        }
    }
}

double tract_from_half(uint16_t half)
{
    enum { INFINITE = 31, HALF_BIAS = 15, DOUBLE_BIAS = 1023 };
    uint64_t exponent = half >> 10 & INFINITE;
    uint64_t fraction = half & 0x3ffU;
    double value = (double)fraction * 0x1p-24; /* subnormal */
    if (exponent == INFINITE) {
        value = fraction ? (double)NAN : (double)INFINITY;
    } else if (exponent) {
        uint64_t bits = (exponent - HALF_BIAS + DOUBLE_BIAS) << 52 | fraction << 42;
        memcpy(&value, &bits, sizeof value);
    }
    return half & 0x8000U ? -value : value;
}

uint32_t tractogram_streamline_of(const struct tractogram *tractogram, uint64_t index)
{
    const uint32_t *marks = tractogram->tree.marks;
    size_t mark = (size_t)(index / TRACT_MARK);
    size_t low = marks ? marks[mark] : 0;
    size_t high = tractogram->streamline_count;
    assert(index < tractogram->point_count);
    if (marks && mark + 1 < tract_mark_count(tractogram->point_count)) {
        high = (size_t)marks[mark + 1] + 1;
    }
    while (high - low > 1) { /* first[low] <= index < first[high] */
        size_t middle = low + (high - low) / 2;
        *(tractogram->first[middle] <= index ? &low : &high) = middle;
    }
    return (uint32_t)low;
}

static conus_status check_first(const struct tractogram *tractogram)
{
    const uint64_t *first = tractogram->first;
    size_t count = tractogram->streamline_count;
    if (count >= UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "streamlines: found %zu, allowed are %u", count, UINT32_MAX - 1);
    }
    if (first[0] != 0 || first[count] != tractogram->point_count) {
        return fail(CONUS_ERROR_DATA, "streamlines: they have the points %llu to %llu, needed are all from 0 to %llu",
                    (unsigned long long)first[0], (unsigned long long)first[count],
                    (unsigned long long)tractogram->point_count);
    }
    for (size_t k = 0; k < count; k++) {
        if (first[k] > first[k + 1]) {
            return fail(CONUS_ERROR_DATA, "streamline %zu (from 0): begins at point %llu and ends before point %llu", k,
                        (unsigned long long)first[k], (unsigned long long)first[k + 1]);
        }
    }
    return CONUS_OK;
}

bool tract_points_are_within(const void *user, size_t from, size_t to)
{
    enum { EXPONENT = 0x7c00 };
    const struct tractogram *tractogram = user;
    int beyond = 0;
    for (uint64_t i = 3 * (uint64_t)from; tractogram->points && i < 3 * (uint64_t)to;
         i++) { /* compilers vectorise it */
        beyond |= !(fabsf(tractogram->points[i]) <= (float)TRACT_COORDINATE_LIMIT);
    }
    for (uint64_t i = 3 * (uint64_t)from; !tractogram->points && i < 3 * (uint64_t)to; i++) {
        beyond |= (tractogram->halves[i] & EXPONENT) == EXPONENT; /* the largest half is 65504 */
    }
    return !beyond;
}

static conus_status check_points(const struct tractogram *tractogram)
{
    assert(tractogram->points || tractogram->halves || !tractogram->point_count);
    for (size_t k = 0; k < tractogram->streamline_count; k++) {
        uint64_t begin = tractogram->first[k];
        uint64_t count = tractogram->first[k + 1] - tractogram->first[k];
        if (!tract_points_are_within(tractogram, (size_t)begin, (size_t)(begin + count))) {
            uint64_t i = 0;
            while (i + 1 < count && tract_points_are_within(tractogram, (size_t)(begin + i), (size_t)(begin + i + 1))) {
                i++;
            }
            char text[3][TEXT_NUMBER_SIZE];
            double point[3];
            tractogram_point(point, tractogram, begin + i);
            return fail(CONUS_ERROR_DATA,
                        "point %llu of streamline %zu (both from 0): found (%s, %s, %s) mm, allowed is within 1e9 of 0",
                        (unsigned long long)i, k, text_number(text[0], point[0]), text_number(text[1], point[1]),
                        text_number(text[2], point[2]));
        }
    }
    return CONUS_OK;
}

static conus_status check_group(const struct tract_group *group, size_t streamline_count)
{
    for (size_t i = 0; i < group->count; i++) {
        if (group->members[i] >= streamline_count) {
            return fail(CONUS_ERROR_DATA, "group '%s': found streamline %u, the file has %zu, from 0", group->name,
                        group->members[i], streamline_count);
        }
        if (i && group->members[i - 1] >= group->members[i]) {
            return fail(CONUS_ERROR_DATA, "group '%s': found streamline %u after %u, needed are ascending numbers",
                        group->name, group->members[i], group->members[i - 1]);
        }
    }
    return CONUS_OK;
}

bool tract_group_has(const struct tract_group *group, uint32_t streamline)
{
    return !group ||
           (group->count && bsearch(&streamline, group->members, group->count, sizeof *group->members, compare_u32));
}

conus_status tractogram_check(const struct tractogram *tractogram, struct notes *notes)
{
    if (!(tractogram->radius > 0 && tractogram->radius <= TRACT_RADIUS_LIMIT)) {
        char text[TEXT_NUMBER_SIZE];
        return fail(CONUS_ERROR_ARGUMENT, "radius: found %s mm, allowed is above 0 and at most %g",
                    text_number(text, tractogram->radius), TRACT_RADIUS_LIMIT);
    }
    conus_status status = check_first(tractogram);
    status = status ? status : check_points(tractogram);
    for (size_t i = 0; !status && i < tractogram->group_count; i++) {
        status = check_group(&tractogram->groups[i], tractogram->streamline_count);
    }
    if (status) {
        return status;
    }
    size_t counts[2] = {0};
    for (size_t k = 0; k < tractogram->streamline_count; k++) {
        uint64_t count = tractogram->first[k + 1] - tractogram->first[k];
        if (count < 2) {
            counts[count]++;
        }
    }
    if (!counts[0] && !counts[1]) {
        return CONUS_OK;
    }
    return notes_add(notes, "streamlines: of %zu, %zu have no point and %zu have one", tractogram->streamline_count,
                     counts[0], counts[1]);
}

static bool has_point(const struct tractogram *tractogram, uint32_t streamline, uint64_t point)
{
    return streamline < tractogram->streamline_count && tractogram->first[streamline] <= point &&
           point < tractogram->first[streamline + 1];
}

/* What the runs of a tree lead to: each streamline's first point is a bit of `starts`. */
struct run_check {
    const struct tractogram *tractogram;
    const uint64_t *starts;
};

enum { WORD = 64, LEAVES_A_THREAD = 1 << 12 };

/* Whether a streamline begins at one of the `count` points, fewer than WORD, from `from` on. */
static bool one_begins(const uint64_t *starts, uint64_t from, unsigned count)
{
    unsigned bit = from % WORD;
    uint64_t bits = starts[from / WORD] >> bit;
    bits |= bit ? starts[from / WORD + 1] << (WORD - bit) : 0;
    return bits & ((UINT64_C(1) << count) - 1);
}

static bool are_runs_of(const struct run_check *check, const struct tract_leaf *leaf, size_t count)
{
    bool sound = leaf->count == count;
    for (size_t lane = 0; lane < count && sound; lane++) {
        uint64_t point = leaf->point[lane];
        uint32_t segments = tract_leaf_segments(leaf, lane);
        sound = segments <= TRACT_RUN && point + segments < check->tractogram->point_count &&
                !one_begins(check->starts, point + 1, segments);
    }
    return sound;
}

static bool runs_are_sound(const void *user, size_t from, size_t to)
{
    const struct run_check *check = user;
    const struct tract_tree *tree = &check->tractogram->tree;
    bool sound = true;
    for (size_t i = from; i < to && sound; i++) {
        size_t left = tree->run_count - i * TRACT_LEAF;
        sound = are_runs_of(check, &tree->leaves[i], left < TRACT_LEAF ? left : TRACT_LEAF);
    }
    return sound;
}

static conus_status check_leaves(const struct tractogram *tractogram)
{
    uint64_t *starts = memory_zeroed((size_t)(tractogram->point_count / WORD) + 2, sizeof *starts);
    const struct run_check check = {tractogram, starts};
    if (!starts) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t k = 0; k < tractogram->streamline_count; k++) {
        starts[tractogram->first[k] / WORD] |= UINT64_C(1) << tractogram->first[k] % WORD;
    }
    bool sound = threads_check(runs_are_sound, &check, tract_leaf_count(tractogram->tree.run_count), LEAVES_A_THREAD);
    memory_free(starts);
    return sound ? CONUS_OK : fail(CONUS_ERROR_DATA, "streamlines: a leaf of their tree leads out of them");
}

conus_status tractogram_check_tree(const struct tractogram *tractogram)
{
    const struct tract_tree *tree = &tractogram->tree;
    conus_status status = check_first(tractogram);
    bool sound =
        !status && tree->run_count <= UINT32_MAX && tree->node_count == tract_levels_of(tree->run_count).node_count;
    for (size_t i = 0; i < tract_mark_count(tractogram->point_count) && sound; i++) {
        sound = has_point(tractogram, tree->marks[i], i * TRACT_MARK);
    }
    status = status || sound ? status : fail(CONUS_ERROR_DATA, "streamlines: their tree does not fit them");
    status = status ? status : check_leaves(tractogram);
    for (size_t i = 0; i < tractogram->group_count && !status; i++) {
        status = check_group(&tractogram->groups[i], tractogram->streamline_count);
    }
    return status;
}

double tractogram_length(const struct tractogram *tractogram, uint32_t number)
{
    const double *lengths = tractogram->tree.lengths;
    double length = lengths ? lengths[number] : 0;
    uint64_t begin = tractogram->first[number];
    uint64_t count = tractogram->first[number + 1] - tractogram->first[number];
    for (uint64_t i = 0; !lengths && i + 1 < count; i++) {
        double points[2][3];
        double step[3];
        tractogram_point(points[0], tractogram, begin + i);
        tractogram_point(points[1], tractogram, begin + i + 1);
        vec3_sub(step, points[1], points[0]);
        length += vec3_length(step);
    }
    return length;
}

struct tract_run tract_run_at(const struct tractogram *tractogram, size_t number)
{
    const struct tract_leaf *leaf = &tractogram->tree.leaves[number / TRACT_LEAF];
    uint32_t point = leaf->point[number % TRACT_LEAF];
    return (struct tract_run){point, tractogram_streamline_of(tractogram, point),
                              tract_leaf_segments(leaf, number % TRACT_LEAF)};
}

struct walk {
    const struct tractogram *tractogram;
    tract_box_test test;
    tract_visit visit;
    void *user;
};

/* The test's answer for the box round a lane's item. */
static enum tract_answer ask(const struct walk *walk, const struct tract_node *node, size_t lane)
{
    double low[3];
    double high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = (double)node->low[a][lane];
        high[a] = (double)node->high[a][lane];
    }
    return walk->test(walk->user, low, high);
}

/* The test's answer for the box round a run. */
static enum tract_answer ask_run(const struct walk *walk, const struct tract_leaf *leaf, size_t lane)
{
    double thickness = (double)leaf->thickness * (leaf->bend[lane] >> TRACT_SEGMENTS_BITS);
    double low[3];
    double high[3];
    for (int a = 0; a < 3; a++) {
        double one = (double)leaf->low[a] + (double)leaf->step[a] * leaf->ends[0][a][lane];
        double other = (double)leaf->low[a] + (double)leaf->step[a] * leaf->ends[1][a][lane];
        low[a] = fmin(one, other) - thickness;
        high[a] = fmax(one, other) + thickness;
    }
    return walk->test(walk->user, low, high);
}

/* Prefetches what is read of a run. */
static void fetch_run(const struct tractogram *tractogram, const struct tract_leaf *leaf, size_t lane)
{
    tract_fetch_points(tractogram, leaf->point[lane], tract_leaf_segments(leaf, lane));
    __builtin_prefetch(&tractogram->tree.marks[leaf->point[lane] / TRACT_MARK]);
}

static void walk_leaf(const struct walk *walk, size_t number, bool inside)
{
    const struct tract_leaf *leaf = &walk->tractogram->tree.leaves[number];
    size_t lanes[TRACT_LEAF];
    enum tract_answer answers[TRACT_LEAF];
    size_t count = 0;
    for (size_t lane = 0; lane < leaf->count; lane++) {
        enum tract_answer answer = inside ? TRACT_INSIDE : ask_run(walk, leaf, lane);
        if (answer != TRACT_OUTSIDE) {
            fetch_run(walk->tractogram, leaf, lane);
            __builtin_prefetch(&walk->tractogram->first[walk->tractogram->tree.marks[leaf->point[lane] / TRACT_MARK]]);
            answers[count] = answer;
            lanes[count++] = lane;
        }
    }
    for (size_t i = 0; i < count; i++) {
        struct tract_run run = tract_run_at(walk->tractogram, number * TRACT_LEAF + lanes[i]);
        walk->visit(walk->user, &run, answers[i] == TRACT_INSIDE);
    }
}

/* A leaf is the first one of an item of each level up to some level. So the leaf and a level are the state of the
 * traversal. */
void tract_tree_walk(const struct tractogram *tractogram, tract_box_test test, tract_visit visit, void *user)
{
    const struct walk walk = {tractogram, test, visit, user};
    const struct tract_tree *tree = &tractogram->tree;
    struct tract_levels levels = tract_levels_of(tree->run_count);
    size_t leaf_count = tract_leaf_count(tree->run_count);
    unsigned level = levels.count - 1;
    for (size_t leaf = 0; leaf < leaf_count;) {
        size_t item = leaf >> TRACT_WIDTH_BITS * level;
        const struct tract_node *node = &tree->nodes[levels.first[level] + item / TRACT_WIDTH];
        enum tract_answer answer = ask(&walk, node, item % TRACT_WIDTH);
        if (answer == TRACT_PERHAPS && level > 0) {
            level--;
            continue;
        }
        size_t end = leaf + ((size_t)1 << TRACT_WIDTH_BITS * level);
        for (; leaf < end && leaf < leaf_count && answer != TRACT_OUTSIDE; leaf++) {
            if (answer == TRACT_INSIDE && leaf + 1 < end && leaf + 1 < leaf_count) {
                const struct tract_leaf *next = &tractogram->tree.leaves[leaf + 1];
                for (size_t lane = 0; lane < next->count; lane++) {
                    fetch_run(tractogram, next, lane);
                }
            }
            walk_leaf(&walk, leaf, answer == TRACT_INSIDE);
        }
        leaf = end;
        while (level + 1 < levels.count && (leaf >> TRACT_WIDTH_BITS * level) % TRACT_WIDTH == 0) {
            level++;
        }
    }
}
