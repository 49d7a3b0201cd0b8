/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The ranking of results by a score. */
#ifndef CONUS_SELECTION_RANK_H
#define CONUS_SELECTION_RANK_H

#include "selection/selection.h"
#include "selection/selector.h"

/** Parses options.score, which is not kept, and makes ready what it needs. */
conus_status selector_prepare_ranking(conus_selector *selector);
/** Its part that each selector has for itself: on_border. */
conus_status selector_prepare_border(conus_selector *selector);

/** Ranks the results; @p history may be NULL unless the ranking needs it. */
void selection_rank(conus_selection *selection, conus_selector *selector, const struct history *history);

#endif
