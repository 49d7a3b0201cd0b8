/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A bounding volume hierarchy: a tree of boxes along the axes, searched along rays and round needles. Every box
 * is taken to be a little larger than it is (BVH_SLACK), far more than rounding in double precision moves a ray. So a
 * triangle that mesh_is_passed() accepts lies in boxes that the ray hits. */
#ifndef CONUS_ATLAS_SURFACE_BVH_H
#define CONUS_ATLAS_SURFACE_BVH_H

#include "base/geometry/needle.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Relative to the largest coordinate of the boxes and of the ray's origin. */
#define BVH_SLACK 1e-6

/** Bounds, edges included. */
struct bvh_box {
    float low[3], high[3];
    uint32_t number; /**< The caller's number of the box. */
};

struct bvh_node;

/** A zeroed one is empty: a search finds nothing. */
struct bvh {
    struct bvh_node *nodes; /**< Each before those below it; the first one holds all. Owned. */
    uint32_t *numbers;      /**< [count] of the boxes, leaf by leaf. Owned.                  */
    size_t count;
};

/** Extends @p box to @p point. */
void bvh_box_extend(struct bvh_box *box, const float point[3]);

/** A box that holds nothing yet. */
struct bvh_box bvh_box_empty(uint32_t number);

/** The box round @p count boxes, with number 0. */
struct bvh_box bvh_box_around(const struct bvh_box *boxes, size_t count);

/** The longest axis, 0 to 2; of equally long ones the first. */
int bvh_box_longest_axis(const struct bvh_box *box);

/** Reorders boxes: those with the lower middles along @p axis come before boxes[half]; half is below count. */
void bvh_halve(struct bvh_box *boxes, size_t count, size_t half, int axis);

/** Makes a tree of @p count boxes, at most UINT32_MAX, and reorders them. The same boxes in the same order give the
 * same tree. CONUS_ERROR_MEMORY. */
conus_status bvh_init(struct bvh *out, struct bvh_box *boxes, size_t count);
void bvh_finish(struct bvh *bvh);

/** Nodes on the stack of a search: each step down leaves one behind, and halving UINT32_MAX boxes takes 32 steps. */
enum { BVH_DEPTH = 33 };

/** A search on its way. */
struct bvh_search {
    const struct bvh *bvh;
    const struct needle_frame *needle; /**< Round which it goes; NULL: along a ray. */
    double origin[3];
    double inverse[3]; /**< 1 / direction; infinite where that is 0. */
    double slack;
    size_t next, end; /**< The rest of a leaf, in bvh->numbers. */
    struct bvh_visit {
        double enter; /**< Where the ray enters the node's box, or how far the needle is from it. */
        uint32_t node;
    } visits[BVH_DEPTH]; /**< A stack of nodes to visit. */
    size_t waiting;
};

/** Begins a search along a ray from @p origin; both arrays are copied, @p bvh must outlive the search. */
void bvh_search_init(struct bvh_search *out, const struct bvh *bvh, const double origin[3], const double direction[3]);

/** Begins a search round @p needle, in the frame of the boxes; both must outlive the search. Boxes are as they are. */
void bvh_search_round(struct bvh_search *out, const struct bvh *bvh, const struct needle_frame *needle);

/** The next number, approximately from near to far, whose leaf the ray hits at @p limit (in units of the direction's
 * length) or before, or is no farther from the needle than that, mm; false after the last. The limit may shrink from
 * call to call. The ray may miss the number's own box. */
bool bvh_search_next(uint32_t *number, struct bvh_search *search, double limit);

#endif
