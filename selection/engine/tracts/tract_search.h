/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A search along a ray in the tree of a tractogram, for segments that it may hit (Eq. 18). It works in single precision
 * with everything taken to be a little larger than it is, so that no segment is lost; capsule_interval() decides. */
#ifndef CONUS_SELECTION_ENGINE_TRACTS_TRACT_SEARCH_H
#define CONUS_SELECTION_ENGINE_TRACTS_TRACT_SEARCH_H

#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tract_start.h"

/** Segments of one run. */
struct tract_found {
    uint64_t point;    /**< The run's first one. */
    uint32_t segments; /**< In the run; 0 = its point alone. */
    uint32_t hit;      /**< Bit k: the segment from point + k on, or the point alone. */
};

/** Limits of the two stacks of a search: each level leaves fewer than TRACT_WIDTH items waiting; runs are put aside. */
enum { TRACT_WAITING = TRACT_WIDTH * TRACT_LEVELS, TRACT_ASIDE = TRACT_LEAF + 16 };

/** A search on its way. */
struct tract_search {
    const struct tractogram *tractogram;
    struct tract_levels levels;
    struct tract_start from;
    float slopes[TRACT_DIAGONALS]; /**< 1 / how much farther along a diagonal the ray is after a mm; finite. */
    float axes[3][3];              /**< Unit vectors, square to each other; the last one is the direction. */
    bool has_bound;                /**< Only the first hit is asked for, and any streamline may be it. */
    float bound;                   /**< mm from the search's origin: with a bound the first hit is no farther. */
    size_t waiting;
    size_t aside;       /**< Runs that are put aside; once they are sorted out,    */
    size_t ready, next; /**< so many are ready, and those from the next one are left. */
    struct tract_visit {
        float enter;    /**< mm from the search's origin: the ray is not in the item before. */
        uint32_t level; /**< 0 a run, 1 a leaf, l + 1 an item of level l. */
        size_t item;
    } visits[TRACT_WAITING], runs[TRACT_ASIDE]; /**< Stacks: the last one comes first. */
};

/** Begins a search along the ray from @p origin; @p tractogram must outlive it. */
void tract_search_init(struct tract_search *out, const struct tractogram *tractogram, const double origin[3],
                       const double direction[3]);

/** The next run, roughly from near to far, that may have a segment which the ray hits at @p limit mm from its origin or
 * before; false after the last. The limit may shrink from call to call. */
typedef bool tract_search_next(struct tract_found *out, struct tract_search *search, double limit);

/** The fastest one that this machine supports. */
tract_search_next *tract_search_best(void);

/** Number @p index of them, the fastest first; NULL where this machine does not support it, or past the last. */
tract_search_next *tract_search_kernel(size_t index);
enum { TRACT_SEARCH_KERNELS = 2 };

#endif
