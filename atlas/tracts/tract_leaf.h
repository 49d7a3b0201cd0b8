/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a leaf of the tree has of its runs: their hull, and their ends in bytes. One kernel per instruction set;
 * every kernel gives the same bits. */
#ifndef CONUS_ATLAS_TRACTS_TRACT_LEAF_H
#define CONUS_ATLAS_TRACTS_TRACT_LEAF_H

#include "atlas/tracts/tract_node.h"

#include <math.h>

/** Far above the rounding of a run's thickness, which must not be too small. */
#define TRACT_BEND_SLACK 1e-6

struct box {
    float low[3], high[3];
};

static inline struct box no_box(void)
{
    return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static inline void extend(struct box *box, const float low[3], const float high[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = low[a] < box->low[a] ? low[a] : box->low[a];
        box->high[a] = high[a] > box->high[a] ? high[a] : box->high[a];
    }
}

/** A box, and its extent along its diagonals. */
struct hull {
    struct box box;
    double low[TRACT_DIAGONALS], high[TRACT_DIAGONALS];
};

static inline struct hull no_hull(void)
{
    struct hull hull = {.box = no_box()};
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        hull.low[d] = INFINITY;
        hull.high[d] = -INFINITY;
    }
    return hull;
}

static inline void extend_hull(struct hull *hull, const struct hull *by)
{
    extend(&hull->box, by->box.low, by->box.high);
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        hull->low[d] = by->low[d] < hull->low[d] ? by->low[d] : hull->low[d];
        hull->high[d] = by->high[d] > hull->high[d] ? by->high[d] : hull->high[d];
    }
}

/** The runs of a leaf, and what is found of each, side by side, so that compilers make vectors of loops over lanes. A
 * run that is shorter than others has its first point again where it has none: that point is in its box, on its chord,
 * and among those whose distance counts, anyway. Lanes without a run have another lane's. */
struct tract_runs {
    uint32_t longest;                       /**< Segments, at least 1. */
    float points[TRACT_RUN][3][TRACT_LEAF]; /**< Those before the longest one's last. */
    float last[3][TRACT_LEAF];
    double away[TRACT_RUN][3][TRACT_LEAF]; /**< From the chord to each point. */
    double shift[3][TRACT_LEAF];           /**< Of the ends from the points there. */
    double ends[2][3][TRACT_LEAF];         /**< As the leaf has them. */
    double bends[TRACT_LEAF]; /**< mm: at least how far the points are from the segment between the ends. */
};

/** Sets low, step and ends of @p leaf, the hull of all runs, and what @p runs has beside points and `longest`. */
typedef void tract_leaf_kernel(struct tract_leaf *leaf, struct hull *hull, struct tract_runs *runs);

tract_leaf_kernel tract_leaf_set_plain, tract_leaf_set_avx2;

#endif
