/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The layout of a tract_tree, for those who search it with means of their own.
 *
 * An item of level 0 is a run, one of level l + 1 is a node with up to TRACT_WIDTH items of level l. All nodes but the
 * last ones of their levels are full. So item i of a level is lane i % TRACT_WIDTH of the node i / TRACT_WIDTH above
 * it, and no node says where its items are. The nodes above level 0 come first, the root is the last one. */
#ifndef CONUS_ATLAS_TRACTS_TRACT_NODE_H
#define CONUS_ATLAS_TRACTS_TRACT_NODE_H

#include "atlas/tracts/tract_tree.h"

enum {
    TRACT_WIDTH = 8,
    TRACT_WIDTH_BITS = 3,
    TRACT_LEVELS = 11 /**< 8^11 is more than UINT32_MAX runs */
};

/** Where its items are; 0 in lanes without one. Above level 0 they are in the boxes from a to b, and nothing is thick.
 * A run is no farther than the thickness from the segment from a to b; and of every two of its segments, counted from
 * its beginning, the point between them is no farther than the fine thickness from the line between the outer ones. */
struct tract_node {
    float a[3][TRACT_WIDTH], b[3][TRACT_WIDTH], thickness[TRACT_WIDTH], fine[TRACT_WIDTH];
};

/** Where the nodes of a tree are. */
struct tract_levels {
    unsigned count;             /**< Of levels of items that have a node above them; 0 = an empty tree. */
    size_t items[TRACT_LEVELS]; /**< Of each level. */
    size_t first[TRACT_LEVELS]; /**< first[l]: the first node above the items of level l. */
    size_t node_count;
};

/** Of a tree of @p run_count runs, at most UINT32_MAX. */
struct tract_levels tract_levels_of(size_t run_count);

#endif
