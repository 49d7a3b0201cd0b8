/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Ranks the objects that a cone hit (Eq. 12): a table of scores, and formulas over them. */
#ifndef CONUS_SELECTION_MEASURE_SCORE_H
#define CONUS_SELECTION_MEASURE_SCORE_H

#include "conus/own.h"
#include "selection/measure/formula.h"
#include "selection/measure/history.h"
#include "selection/measure/statistics.h"

/** Input of a score beside the result. */
struct score_view {
    const struct cone *cone;
    uint32_t cone_pixels;          /**< Pixels of the aperture.                                      */
    double near, far;              /**< Distances of the box around the atlas from the apex, mm; needs_box.   */
    const bool *on_border;         /**< By object; only where ranking.needs_border.                  */
    const struct history *history; /**< NULL = none; only where ranking.info.needs_history.          */
};

/** One way of scoring; higher scores come first. */
struct score {
    conus_score_info info;
    double (*value)(const conus_result *result, const struct score_view *view);
    unsigned history; /**< Parts of it that the score lives on; 0 unless info.needs_history. */
    bool needs_border, needs_box, needs_posterior;
};

/** The ranking of a selector: a formula over the table's names. */
struct ranking {
    struct formula formula;
    conus_score_info info; /**< Its needs; without name and description. */
    uint32_t uses;         /**< Bit n: the table's n-th score.         */
    unsigned history;      /**< The parts of a history that the scores use. */
    bool needs_border, needs_box, needs_posterior;
};

/** Parses a name or formula, NULL = the default. CONUS_ERROR_ARGUMENT says what is wrong with it. */
conus_status ranking_parse(struct ranking *out, const char *text);

/** IntenSelect's contribution of one moment, 0 to 1: 1 - atan(d_perp / d_proj^k) / theta for the object's contact, in
 * metres, theta being half the cone's angle; 0 for an object that no pixel hit first. In a cylinder, where there is no
 * theta, 1 - d_perp / radius. @p exponent is k, in (0, 1]. */
double score_contribution(const conus_result *result, const struct cone *cone, double exponent);

/** Fills score and rank and sorts by rank, the highest score first and what has none last; ties go to the larger
 * share, then the nearer, then the lower object number. CONUS_KIND_UNASSIGNED stays last. */
void score_rank(struct statistics *statistics, const struct ranking *ranking, const struct score_view *view);

#endif
