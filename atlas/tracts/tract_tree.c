/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks trees of streamlines. */
#include "atlas/tracts/tract_tree.h"

#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "base/memory.h"

#include <math.h>

void tract_tree_finish(struct tract_tree *tree)
{
    memory_free(tree->nodes);
    memory_free(tree->leaves);
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

/* What the test says of the box round a lane's item. */
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

/* And of that round a run. */
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

/* Or the processor would wait for each run's. */
static void fetch_points(const struct tractogram *tractogram, const struct tract_leaf *leaf, size_t lane)
{
    size_t size = tractogram->points ? sizeof *tractogram->points : sizeof *tractogram->halves;
    const char *points = tractogram->points ? (const char *)tractogram->points : (const char *)tractogram->halves;
    points += 3 * size * leaf->point[lane];
    __builtin_prefetch(points);
    __builtin_prefetch(points + 3 * size * tract_leaf_segments(leaf, lane));
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
            fetch_points(walk->tractogram, leaf, lane);
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

/* A leaf is the first one of an item of each level up to some level. So the leaf and a level say where the walk is. */
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
                    fetch_points(tractogram, next, lane);
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
