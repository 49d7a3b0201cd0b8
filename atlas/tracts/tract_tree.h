/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A tree of boxes around runs of streamlines' segments. A leaf has runs of neighbouring streamlines side by
 * side, with ends in bytes, so that a search reads it at once and few points. The tree is small beside the points
 * (streamlines of 100 points have 4.4 bytes of it a point, or 2.7 if points are halves), flat, and the same for the
 * same points, so it can be packed and mapped. tract_node.h has its layout. */
#ifndef CONUS_ATLAS_TRACTS_TRACT_TREE_H
#define CONUS_ATLAS_TRACTS_TRACT_TREE_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Segments of a run at most, and points from one mark to the next. */
enum { TRACT_RUN = 7, TRACT_MARK = 64 };

/** Neighbouring segments of a streamline, between the points `point` and `point + segments`. Runs that follow each
 * other share a point. A streamline of one point is a run of no segment. */
struct tract_run {
    uint64_t point;
    uint32_t streamline;
    uint32_t segments; /**< 0 to TRACT_RUN */
};

struct tract_leaf;
struct tract_node;
struct tractogram;

/** A zeroed one is empty. */
struct tract_tree {
    struct tract_node *nodes;
    size_t node_count;
    struct tract_leaf *leaves;
    size_t run_count;
    double *lengths; /**< [streamline_count] mm, of the streamlines. */
    uint32_t *marks; /**< [tract_mark_count()] Streamline of every TRACT_MARK-th point, from the first one on. */
};

/** Frees what it has. */
void tract_tree_finish(struct tract_tree *tree);

/** How many leaves have @p run_count runs. */
size_t tract_leaf_count(size_t run_count);

/** How many marks there are for @p point_count points. */
size_t tract_mark_count(uint64_t point_count);

/** Run @p number, below the tree's run_count, in the order of the leaves. */
struct tract_run tract_run_at(const struct tractogram *tractogram, size_t number);

/** How a box, its border included, lies to the region that is searched. */
enum tract_answer { TRACT_OUTSIDE, TRACT_PERHAPS, TRACT_INSIDE };
typedef enum tract_answer (*tract_box_test)(void *user, const double low[3], const double high[3]);

/** Receives a run whose box is not outside; @p inside: the test has said so for a box around it. */
typedef void (*tract_visit)(void *user, const struct tract_run *run, bool inside);

/** Calls @p visit for all runs of @p tractogram in boxes that @p test does not call outside, in the order of the
 * leaves. Boxes are those of the polylines, those of single runs a little larger; for capsules the test grows them by
 * the radius. */
void tract_tree_walk(const struct tractogram *tractogram, tract_box_test test, tract_visit visit, void *user);

#endif
