/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A selection, the answer of a selector, from inside; and the steps in which it is made. */
#ifndef CONUS_SELECTION_SELECTION_H
#define CONUS_SELECTION_SELECTION_H

#include "atlas/areas/level.h"
#include "conus/selection.h"
#include "selection/evidence/layers.h"
#include "selection/measure/statistics.h"
#include "selection/region/region.h"

struct conus_selection {
    const conus_atlas *atlas; /**< Must outlive the selection. */
    conus_sampling sampling;
    double slice_fraction; /**< F of Eq. 7; 0 with exact sampling. */
    char engine[96];
    struct cone cone;
    struct region region;     /**< Where voxels are counted: the cone, or a ball. Of a ball, the cone is nothing but
                                   its centre and has no pixels. */
    bool is_point;            /**< The ball stands for its centre: the results are of what is there or nearest. */
    struct evidence evidence; /**< Objects as they are reported. None where `is_counted`. */
    struct hit_counts counts; /**< In its place. */
    bool is_counted;
    uint32_t *own;   /**< [n*n] The objects hit, before --level; NULL where each is reported as itself. */
    uint32_t *group; /**< [object_count + 1] The object as which each one is reported; NULL likewise. */
    bool has_layers;
    struct layers layers; /**< Sorted, if has_layers; objects as they are reported. */
    bool *in_cone;        /**< [n*n] */
    struct statistics statistics;
    bool is_step;
    conus_step step;
};

/** The object that @p pixel hit first, whatever it is reported as. */
static inline uint32_t selection_own_object(const conus_selection *selection, size_t pixel)
{
    return selection->own ? selection->own[pixel] : selection->evidence.object[pixel];
}

/** From here on the evidence has the objects as which its own are reported. */
conus_status selection_regroup(conus_selection *selection, const struct level *level);

/** Sets the kind of every result. */
void selection_set_kinds(conus_selection *selection);

/** How many selections are best traced at once: 1 unless the engine traces many, then as many as fit in memory with
 * ease. */
size_t selections_at_once(const conus_selector *selector);

/** selection_trace() in three steps, so that selections of one selector can be traced together: all are begun, traced
 * (NULL is passed over), and completed in any order. After a failure they can only be destroyed. */
conus_status selection_begin(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle);
conus_status selections_trace(conus_selection *const *selections, size_t count, conus_selector *selector);
conus_status selection_complete(conus_selection *selection, conus_selector *selector);

/** conus_select() without the ranking. */
conus_status selection_trace(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle);

#endif
