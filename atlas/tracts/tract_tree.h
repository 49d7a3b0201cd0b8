/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A tree of boxes round runs of streamlines' segments. It is small beside the points (a leaf is a run of up to
 * TRACT_RUN segments of one streamline; streamlines of 100 points have 3.7 bytes of it a point), flat, and the same for
 * the same points, so it can be packed and mapped. tract_node.h says how it lies in memory. */
#ifndef CONUS_ATLAS_TRACTS_TRACT_TREE_H
#define CONUS_ATLAS_TRACTS_TRACT_TREE_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TRACT_RUN = 16 };

/** Neighbouring segments of a streamline: of the points `point` to `point + segments`. Both ends of a run are points,
 * of which runs that follow each other share one. A streamline of one point is a run of no segment. */
struct tract_run {
    uint64_t point;
    uint32_t streamline;
    uint32_t segments; /**< 0 to TRACT_RUN */
};

struct tract_node;
struct tractogram;

/** A zeroed one is empty. */
struct tract_tree {
    struct tract_node *nodes;
    size_t node_count;
    struct tract_run *runs; /**< In the order of the tree's leaves. */
    size_t run_count;
};

/** What a box, its border included, has to do with what is looked for. */
enum tract_answer { TRACT_OUTSIDE, TRACT_PERHAPS, TRACT_INSIDE };
typedef enum tract_answer (*tract_box_test)(void *user, const double low[3], const double high[3]);

/** A run whose box is not outside; @p inside: the test has said so of a box around it. */
typedef void (*tract_visit)(void *user, const struct tract_run *run, bool inside);

/** Calls @p visit for all runs in boxes that @p test does not call outside, in the order of the leaves. Boxes are
 * those round the polylines, those of single runs a little larger; who asks for capsules grows them by the radius. */
void tract_tree_walk(const struct tract_tree *tree, tract_box_test test, tract_visit visit, void *user);

#endif
