/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A pose that is tried: what a plan asks of it, and how much of that has to be measured (Eq. 22). */
#ifndef CONUS_SELECTION_PLAN_PLAN_TRIAL_H
#define CONUS_SELECTION_PLAN_PLAN_TRIAL_H

#include "conus/pose.h"
#include "selection/plan/plan.h"

/** The constraints and options of a plan; a run does not change them. */
struct plan_asked {
    conus_selector *selector;
    conus_plan_options options; /**< Defaults filled in; strings and shanks are not kept. */
    struct plan_constraint *constraints;
    size_t count;
    struct plan_order order;
    struct plan_jitter jitter;
    bool measures_all; /**< Of every pose, also what decides nothing. */
};

/** The results of earlier poses, so that less has to be measured of later ones. */
struct plan_bar {
    bool has_maps; /**< All constraints have maps. */
    bool has_feasible;
    bool is_full;      /**< Keys are those of the last pose of a full list: whatever follows has to be better. */
    size_t infeasible; /**< So many are kept. */
    double *keys;      /**< [rank_count] */
    double *misses;    /**< [count] By how much the nearest miss breaks each constraint. */
};

conus_status plan_bar_init(struct plan_bar *out, const struct plan_asked *asked);
void plan_bar_finish(struct plan_bar *bar);
void plan_bar_copy(struct plan_bar *to, const struct plan_bar *from, const struct plan_asked *asked);

/** The scratch with which one thread tries poses. */
struct plan_worker {
    struct plan_judge judge;
    struct plan_bar bar; /**< As it was when the pose's turn came. */
};

/** A pose that is tried. */
struct plan_trial {
    conus_planned planned; /**< The id is that at `id` of its block's strings. */
    size_t id;
    conus_verdict *verdicts;
    double *keys; /**< As they are compared. */
    double *bar;  /**< [rank_count] What it has to be better than, where it has a bar: the last of a full list, or
                     the best of its entry or target so far where that is less. */
    bool has_bar;
    bool is_known;    /**< It was judged before, and is feasible. */
    bool is_measured; /**< All of this is whole. */
    double most;      /**< mm: else, where it is feasible, what its leeway does not exceed. */
    bool is_lone;     /**< It breaks planned.broken and nothing else. */
};

/** Why a row is no candidate; NULL where it is one, and @p out has its needle. */
const char *plan_trial_begin(conus_planned *out, const conus_pose_row *row, const struct plan_asked *asked);

/** Has a judge that is turned to the pose give all verdicts, with so much care, and sums them up. */
conus_status plan_trial_measure(struct plan_trial *trial, struct plan_judge *judge, const struct plan_asked *asked,
                                enum plan_care care);

/** Tries the pose, which was begun: it is whole where it may be kept. */
conus_status plan_trial_try(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked);

/** The same of a pose that is known to be feasible; of one that is measured its leeway is known. */
conus_status plan_trial_again(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked);

#endif
