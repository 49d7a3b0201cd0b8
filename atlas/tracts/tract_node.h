/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The tree of a tractogram in memory, and where a search along a ray starts in it, for searches of other
 * kinds. */
#ifndef CONUS_ATLAS_TRACTS_TRACT_NODE_H
#define CONUS_ATLAS_TRACTS_TRACT_NODE_H

#include "atlas/tracts/tractogram.h"

/* The layout of a tract_tree in memory, for searches of other kinds. An item of level 0 is a leaf, one of level l +
 * 1 is a node with up to TRACT_WIDTH items of level l. All nodes and leaves but the last ones of their levels are
 * full. So item i of a level is lane i % TRACT_WIDTH of the node i / TRACT_WIDTH above it, and no node says where
 * its items are. The nodes above level 0 come first, the root is the last one. Run r is lane r % TRACT_LEAF of leaf
 * r / TRACT_LEAF. */

enum {
    TRACT_WIDTH = 16,
    TRACT_WIDTH_BITS = 4,
    TRACT_DIAGONALS = 4,
    TRACT_CUTS = 256,
    TRACT_LEVELS = 8, /**< 16^8 is more than UINT32_MAX leaves */
    TRACT_LEAF = 32,
    TRACT_SEGMENTS_BITS = 3 /**< TRACT_RUN is less than 2^3 */
};

/** The boxes around its items, from low to high; 0 in empty lanes. Diagonal d of a box has the direction
 * tract_diagonal(); its corners are as far apart along it as the box is long along its three axes together, and
 * cut[0][d] and cut[1][d] TRACT_CUTS-ths of this are empty at either end. */
struct tract_node {
    float low[3][TRACT_WIDTH], high[3][TRACT_WIDTH];
    uint8_t cut[2][TRACT_DIAGONALS][TRACT_WIDTH];
};

/** 1 or -1: the direction of a box's diagonal along an axis. */
static inline int tract_diagonal(int diagonal, int axis)
{
    return axis + 1 == diagonal ? -1 : 1;
}

/** Runs near each other. Run k is no farther than its thickness from the segment between its ends. These are no farther
 * than that and tract_leaf_rounding() from its first and its last point. A coordinate of an end is low + step e. */
struct tract_leaf {
    float low[3], step[3];          /**< World mm. */
    float thickness;                /**< mm; a run has a multiple of it. */
    uint32_t count;                 /**< How many runs. The arrays are 0 in lanes without one. */
    uint8_t ends[2][3][TRACT_LEAF]; /**< e of the run's first end, and of its last one. */
    uint8_t bend[TRACT_LEAF];       /**< Multiple of the thickness, and in the lowest bits the segments. */
    uint32_t point[TRACT_LEAF];     /**< The run's first one, of all points of the tractogram. */
};

/** mm: about the largest error of an end by rounding to bytes, half the diagonal of a cube of the longest step. */
static inline double tract_leaf_rounding(const struct tract_leaf *leaf)
{
    float longest = leaf->step[0] > leaf->step[1] ? leaf->step[0] : leaf->step[1];
    return 0.866 * (double)(leaf->step[2] > longest ? leaf->step[2] : longest);
}

/** How many segments a run of a leaf has. */
static inline uint32_t tract_leaf_segments(const struct tract_leaf *leaf, size_t lane)
{
    return leaf->bend[lane] & ((1U << TRACT_SEGMENTS_BITS) - 1);
}

/** Where the nodes of a tree are. */
struct tract_levels {
    unsigned count;             /**< How many levels of items have a node above them; 0 = an empty tree. */
    size_t items[TRACT_LEVELS]; /**< How many each level has. */
    size_t first[TRACT_LEVELS]; /**< first[l]: the first node above the items of level l. */
    size_t node_count;
};

/** The levels of a tree of @p run_count runs, at most UINT32_MAX. */
struct tract_levels tract_levels_of(size_t run_count);

/** Prefetches the points of a run. */
static inline void tract_fetch_points(const struct tractogram *tractogram, uint64_t point, uint64_t segments)
{
    size_t size = 3 * (tractogram->points ? sizeof *tractogram->points : sizeof *tractogram->halves);
    const char *points = tractogram->points ? (const char *)tractogram->points : (const char *)tractogram->halves;
    points += size * point;
    __builtin_prefetch(points);
    __builtin_prefetch(points + size * segments);
}

/* The start of a search along a ray in a tractogram, in single precision, and the slack by which everything is then
 * enlarged, so that no segment is lost. Processor and GPU search from there (Eq. 18). */

/** Relative to the largest coordinate and to the radius: far above any rounding in single precision. */
#define TRACT_SLACK 1e-5

struct tract_start {
    double along;        /**< mm from the ray's origin to where the search begins, at the border of the tractogram. */
    float origin[3];     /**< That place. */
    float direction[3];  /**< Unit length. */
    float inverse[3];    /**< 1 / direction, finite. */
    float radius, slack; /**< mm; the slack is no part of the radius. */
};

/** Where the ray from @p origin enters the box around all capsules. False if it misses: then only radius and slack are
 * set, and nothing at all for a tractogram without a point. */
bool tract_start_find(struct tract_start *out, const struct tractogram *tractogram, const double origin[3],
                      const double direction[3]);

/** An upper bound in single precision: a place @p limit mm from the ray's origin is at most so far from the start. */
static inline float tract_start_reach(double limit, double along, float slack)
{
    return (float)((limit - along) * (1 + TRACT_SLACK)) + slack;
}

#endif
