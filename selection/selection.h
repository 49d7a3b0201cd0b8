/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The selector and its answers, from inside. */
#ifndef CONUS_SELECTION_SELECTION_H
#define CONUS_SELECTION_SELECTION_H

#include "atlas/areas/level.h"
#include "selection/engine/evidence.h"
#include "selection/measure/score.h"

struct conus_selector {
    const conus_atlas *atlas;
    conus_selector_options options; /**< Defaults filled in; strings are not kept (score is parsed). */
    struct ranking ranking;
    bool *on_border;  /**< [object_count + 1] All false between rankings; NULL unless ranking.needs_border. */
    double box[2][3]; /**< Around the areas and pathways, world; only where ranking.needs_box. */
    struct level *level;
    char *level_spec; /**< NULL = none. */
    struct engine *engine;
    struct aperture aperture;
    struct tally tally; /**< Prepared for the atlas's objects. */
    struct census census;
    struct near near;
    double *whole;    /**< [object_count + 1] Volumes of what is reported, mm^3; with all layers. */
    bool inside_only; /**< Of its selections only the pixels in the cone will be looked at. */
    bool is_shared;   /**< Engine, level and volumes are another selector's. */
};

struct conus_selection {
    const conus_atlas *atlas; /**< Must outlive the selection. */
    conus_sampling sampling;
    char engine[96];
    struct cone cone;
    struct region region;     /**< Where voxels are counted: the cone, or a ball. Of a ball, the cone is nothing but
                                   its centre and has no pixels. */
    struct evidence evidence; /**< Objects as they are reported. */
    uint32_t *own;            /**< [n*n] What they were before; NULL where every object is reported as itself, */
    uint32_t *group;          /**< [object_count + 1] and as what each one is; NULL likewise. */
    bool has_layers;
    struct layers layers; /**< Sorted, if has_layers; objects as they are reported. */
    bool *in_cone;        /**< [n*n] */
    struct statistics statistics;
    bool is_step;
    conus_step step;
};

/** The object that @p pixel met first, whatever it is reported as. */
static inline uint32_t selection_own_object(const conus_selection *selection, size_t pixel)
{
    return selection->own ? selection->own[pixel] : selection->evidence.object[pixel];
}

/** A selector like @p selector, which must outlive it, with the same engine and scratch of its own: each may answer on
 * another thread, where the engine is rays. */
conus_status selector_share(conus_selector **out, const conus_selector *selector);

/** From here on the evidence has the objects as which its own are reported. */
conus_status selection_regroup(conus_selection *selection, const struct level *level);

/** Sets the kind of every result. */
void selection_set_kinds(conus_selection *selection);

/** Parses options.score, which is not kept, and makes ready what it needs. */
conus_status selector_prepare_ranking(conus_selector *selector);
/** Its part that each selector has for itself: on_border. */
conus_status selector_prepare_border(conus_selector *selector);

/** The tracker's options with defaults filled in. */
const conus_tracker_options *tracker_options(const conus_tracker *tracker);

/** How many selections are best looked at at once: 1 unless the engine looks at many, then as many as are in memory
 * with ease. */
size_t selections_at_once(const conus_selector *selector);

/** selection_trace() in three steps, so that selections of one selector can be looked at together: all are begun,
 * looked at (NULL is passed over), and completed in any order. After a failure they can only be destroyed. */
conus_status selection_begin(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle);
conus_status selections_trace(conus_selection *const *selections, size_t count, conus_selector *selector);
conus_status selection_complete(conus_selection *selection, conus_selector *selector);

/** conus_select() without the ranking. */
conus_status selection_trace(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle);

/** Ranks the results; @p history may be NULL unless the ranking needs it. */
void selection_rank(conus_selection *selection, conus_selector *selector, const struct history *history);

#endif
