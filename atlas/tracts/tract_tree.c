/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks trees of streamlines. */
#include "atlas/tracts/tract_tree.h"

#include "atlas/tracts/tract_node.h"

#include <math.h>

struct tract_levels tract_levels_of(size_t run_count)
{
    struct tract_levels levels = {0};
    for (size_t items = run_count; items > 0 && (items > 1 || levels.count == 0);) {
        levels.items[levels.count] = items;
        items = (items + TRACT_WIDTH - 1) / TRACT_WIDTH;
        levels.first[levels.count++] = levels.node_count;
        levels.node_count += items;
    }
    return levels;
}

/* What the test says of the box round a lane's item. */
static enum tract_answer ask(const struct tract_node *node, size_t lane, tract_box_test test, void *user)
{
    double thickness = (double)node->thickness[lane];
    double low[3];
    double high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = fmin((double)node->a[a][lane], (double)node->b[a][lane]) - thickness;
        high[a] = fmax((double)node->a[a][lane], (double)node->b[a][lane]) + thickness;
    }
    return test(user, low, high);
}

/* A run is the first one of an item of each level up to some level. So the run and a level say where the walk is. */
void tract_tree_walk(const struct tract_tree *tree, tract_box_test test, tract_visit visit, void *user)
{
    struct tract_levels levels = tract_levels_of(tree->run_count);
    unsigned level = levels.count - 1;
    for (size_t run = 0; run < tree->run_count;) {
        size_t item = run >> TRACT_WIDTH_BITS * level;
        const struct tract_node *node = &tree->nodes[levels.first[level] + item / TRACT_WIDTH];
        enum tract_answer answer = ask(node, item % TRACT_WIDTH, test, user);
        if (answer == TRACT_PERHAPS && level > 0) {
            level--;
            continue;
        }
        size_t end = run + ((size_t)1 << TRACT_WIDTH_BITS * level);
        for (; run < end && run < tree->run_count && answer != TRACT_OUTSIDE; run++) {
            visit(user, &tree->runs[run], answer == TRACT_INSIDE);
        }
        run = end;
        while (level + 1 < levels.count && (run >> TRACT_WIDTH_BITS * level) % TRACT_WIDTH == 0) {
            level++;
        }
    }
}
