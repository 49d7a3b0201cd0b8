/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The best combination of one candidate of each list: depth first, with bits for what goes together, and with bounds
 * that prove it. */
#ifndef CONUS_SELECTION_PLAN_TOGETHER_SEARCH_H
#define CONUS_SELECTION_PLAN_TOGETHER_SEARCH_H

#include "selection/plan/together/bodies.h"

enum { NEEDLE_LIMIT = 16 };

/** A candidate, in whole nanometres. */
struct search_item {
    int64_t leeway; /**< 0 without one. */
    int64_t depth;
    uint64_t number;
    size_t index; /**< The caller's. */
};

/** The candidates of a needle: the largest leeway first, of equal ones the least depth, then the least number. */
struct search_list {
    const struct search_item *items; /**< [bodies.count] */
    bool has_leeway;                 /**< Else it does not count for the least one. */
    struct body_list bodies;         /**< Those of the items, in their order. */
};

/** Compares items in that order, for order_sort(). */
int search_item_compare(const void *a, const void *b);

struct search;

/** @p lists must outlive it. Ends with joint_destroy(). @p progress false ends the search. */
conus_status joint_create(struct search **out, const struct search_list *lists, size_t count, uint64_t effort,
                          conus_progress progress, void *progress_user);
void joint_destroy(struct search *search);

/** What was found of some lists. */
struct search_answer {
    bool found;
    size_t chosen[NEEDLE_LIMIT]; /**< Indices into the lists. */
    int64_t least;               /**< Of the quantity: of a leeway that of the candidates, too. */
    int64_t most; /**< Proven: none has more than that. Below the least that was asked for: there is none. */
};

/** Finds some combination with test->least or more. Neither found nor out->most below that: the effort did not do. */
conus_status joint_any(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test);

/** Finds the largest least quantity of the lists in @p among, a bit for each, and a combination that has it. The least
 * of test->least or more; no one has more than @p most. CONUS_ERROR_CANCELLED, with what was found so far. */
conus_status joint_least(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test,
                         int64_t most);

/** Of all combinations whose least leeway is @p found->least the best by sum, depth and numbers (Eq. 27), from that of
 * @p found on. *is_proven: that it is the best. Likewise. */
conus_status joint_best(struct search_answer *found, bool *is_proven, struct search *search,
                        const struct pair_test *test);

/** Nodes so far. */
uint64_t joint_nodes(const struct search *search);

#endif
