/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Rankings of what a cone met (Eq. 12). */
#ifndef CONUS_SELECTION_SCORE_H
#define CONUS_SELECTION_SCORE_H

#include "selection/statistics.h"

/** One way of ranking; higher scores come first. */
struct score {
    conus_score_info info;
    double (*function)(const conus_result *result, const struct cone *cone);
};

/** The score called @p name, NULL = the default; CONUS_ERROR_ARGUMENT lists the known names. */
conus_status score_find(const struct score **out, const char *name);

/** Fills score and rank and sorts by rank; ties go to the larger share, then the nearer, then the lower object
 * number. CONUS_UNASSIGNED stays last. */
void score_rank(struct statistics *statistics, const struct score *score, const struct cone *cone);

#endif
