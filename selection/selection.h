/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Selections and selectors from inside: the answer and its steps, the engine, level and ranking. */
#ifndef CONUS_SELECTION_SELECTION_H
#define CONUS_SELECTION_SELECTION_H

#include "atlas/areas/areas.h"
#include "conus/selection.h"
#include "conus/table.h"
#include "selection/engine/engine.h"
#include "selection/evidence/evidence.h"
#include "selection/measure/measure.h"
#include "selection/measure/score.h"
#include "selection/region/region.h"
#include "selection/weight/weight.h"

/* A selection, the answer of a selector, from inside; and the steps in which it is made. */

struct conus_selection {
    const conus_atlas *atlas; /**< Must outlive the selection. */
    conus_sampling sampling;
    double slice_fraction; /**< F of Eq. 7; 0 with exact sampling. */
    char engine[96];
    struct cone cone;
    struct region region;     /**< Where voxels are counted: the cone, or a ball. Of a ball, the cone is nothing but
                                   its centre and has no pixels. */
    bool is_point;            /**< The ball stands for its centre: the results are of what is there or nearest. */
    struct evidence evidence; /**< Objects as they are reported. */
    uint32_t *own;            /**< [n*n] The objects hit, before --level; NULL where each is reported as itself. */
    uint32_t *group;          /**< [object_count + 1] The object as which each one is reported; NULL likewise. */
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

/* A selector from inside: its engine, level and ranking, and scratch for one thread. */

struct conus_selector {
    const conus_atlas *atlas;
    conus_selector_options options; /**< Defaults filled in; strings are not kept (score is parsed). */
    conus_frame frame;              /**< Of positions in tables. */
    double range[2];                /**< Range of the next question: the options', or a query's own. */
    double degrees, slope;          /**< The last question's angle, which most have, and the tangent of its half. */
    struct ranking ranking;
    bool *on_border;  /**< [object_count + 1] All false between rankings; NULL unless ranking.needs_border. */
    double box[2][3]; /**< Around the areas and pathways, world; 0 of an empty atlas. */
    bool has_box;     /**< Once selector_prepare_box() found one. */
    struct level *level;
    char *level_spec; /**< NULL = none. */
    struct engine *engine;
    struct engine *axis; /**< The engine for axes, exact and on the CPU; NULL until selector_prepare_axis(). */
    bool owns_axis;      /**< It is neither the engine nor another selector's. */
    struct aperture aperture;
    struct soft soft;             /**< With a weight of rays. */
    struct doses doses;           /**< With a weight. */
    struct prior prior;           /**< Where has_posterior. */
    bool has_posterior;           /**< A prior was given, or the score needs it. */
    struct tally tally;           /**< Prepared for the atlas's objects. */
    size_t volume_count;          /**< The atlas's, which may be gone before the selector. */
    struct census_labels *labels; /**< [volume_count], shared by all selectors that share the atlas's labels. */
    struct census census;
    struct near near;
    struct tract_index *tract_index; /**< NULL until selector_prepare_tracts(), and without bundles. */
    bool owns_tract_index;           /**< It is not another selector's. */
    struct tract_census tracts;
    struct clearance clearance;
    struct clearance_index *clearance_index; /**< NULL until selector_prepare_clearance(). */
    bool owns_clearance_index;               /**< It is not another selector's. */
    struct solids solids;                    /**< Volumes of surfaces in the cone. */
    double *whole;                           /**< [object_count + 1] Volumes of what is reported, mm^3. */
    conus_table *areas;                      /**< Those of its last connections; NULL = none yet. */
    bool inside_only;                        /**< Only the pixels in the cone will be traced in its selections. */
    bool is_shared;                          /**< Engine, level and volumes are another selector's. */
};

/** A selector like @p selector, which must outlive it, with the same engine and scratch of its own: each may answer on
 * another thread, where the engine is rays. */
conus_status selector_share(conus_selector **out, const conus_selector *selector);

/** Whether the object's mesh lies in the mesh of an area above it that is reported as the same one, or if @p of_any as
 * any one. */
bool selector_lies_in_mesh(const conus_selector *selector, uint32_t number, bool of_any);

/** Makes selector->box ready, unless it is. Before selectors are shared, theirs is made once. */
conus_status selector_prepare_box(conus_selector *selector);

/** Makes selector->axis ready, unless it is. Before selectors are shared, theirs is made once. */
conus_status selector_prepare_axis(conus_selector *selector);

/** Makes ready what clearance_take() needs, unless it is. Before selectors are shared, theirs is made once. */
conus_status selector_prepare_clearance(conus_selector *selector);

/** Makes selector->tract_index ready, unless it is, and reserves capacity to count streamlines; nothing where no bundle
 * is shown. */
conus_status selector_prepare_tracts(conus_selector *selector);

/** Counts the streamlines in @p region, after selector_prepare_tracts(). NULL where there is no bundle. */
const struct tract_census *selector_take_tracts(conus_selector *selector, const struct region *region);

/* The ranking of results by a score. */

/** Parses options.score, which is not kept, and makes ready what it needs. */
conus_status selector_prepare_ranking(conus_selector *selector);
/** Its part that each selector has for itself: on_border. */
conus_status selector_prepare_border(conus_selector *selector);

/** Ranks the results; @p history may be NULL unless the ranking needs it. */
void selection_rank(conus_selection *selection, conus_selector *selector, const struct history *history);

#endif
