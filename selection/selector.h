/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A selector from inside: its engine, level and ranking, and scratch for one thread. */
#ifndef CONUS_SELECTION_SELECTOR_H
#define CONUS_SELECTION_SELECTOR_H

#include "atlas/areas/level.h"
#include "conus/table.h"
#include "selection/engine/engine.h"
#include "selection/measure/census.h"
#include "selection/measure/clearance.h"
#include "selection/measure/near.h"
#include "selection/measure/score.h"
#include "selection/measure/statistics.h"
#include "selection/weight/weight.h"

struct conus_selector {
    const conus_atlas *atlas;
    conus_selector_options options; /**< Defaults filled in; strings are not kept (score is parsed). */
    conus_frame frame;              /**< Of positions in tables. */
    double range[2];                /**< Range of the next question: the options', or a query's own. */
    double degrees, slope;          /**< The last question's angle, which most have, and the tangent of its half. */
    struct ranking ranking;
    bool *on_border;  /**< [object_count + 1] All false between rankings; NULL unless ranking.needs_border. */
    double box[2][3]; /**< Around the areas and pathways, world: where ranking.needs_box (0 of an empty atlas), and */
    bool has_box;     /**< once a point lies in nothing. */
    struct level *level;
    char *level_spec; /**< NULL = none. */
    struct engine *engine;
    struct engine *axis; /**< The engine for axes, exact and on the CPU; NULL until selector_prepare_axis(). */
    bool owns_axis;      /**< It is neither the engine nor another selector's. */
    struct aperture aperture;
    struct soft soft;             /**< With a weight. */
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
    bool rows_only;                          /**< And nobody asks its selections for pixels, if there is a choice. */
    bool is_shared;                          /**< Engine, level and volumes are another selector's. */
};

/** A selector like @p selector, which must outlive it, with the same engine and scratch of its own: each may answer on
 * another thread, where the engine is rays. */
conus_status selector_share(conus_selector **out, const conus_selector *selector);

/** Whether the object's mesh lies in the mesh of an area above it that is reported as the same one, or if @p of_any as
 * any one. */
bool selector_lies_in_mesh(const conus_selector *selector, uint32_t number, bool of_any);

/** Makes selector->axis ready, unless it is. Before selectors are shared, theirs is made once. */
conus_status selector_prepare_axis(conus_selector *selector);

/** Makes ready what clearance_take() needs, unless it is. Before selectors are shared, theirs is made once. */
conus_status selector_prepare_clearance(conus_selector *selector);

/** Makes selector->tract_index ready, unless it is, and reserves capacity to count streamlines; nothing where no bundle
 * is shown. */
conus_status selector_prepare_tracts(conus_selector *selector);

/** Counts the streamlines in @p region, after selector_prepare_tracts(). NULL where there is no bundle. */
const struct tract_census *selector_take_tracts(conus_selector *selector, const struct region *region);

#endif
