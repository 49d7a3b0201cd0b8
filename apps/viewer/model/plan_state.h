/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The window's state of its plan (plans.h). */
#ifndef CONUS_VIEWER_MODEL_PLAN_STATE_H
#define CONUS_VIEWER_MODEL_PLAN_STATE_H

#include "viewer/model/studier.h"

enum { PLAN_TEXT = 256, PLAN_LINE = 320, PLAN_DETAILS = 2048 };

/** The verdict of a plan's constraints on the first tool. */
struct plan_verdict {
    enum { PLAN_UNKNOWN = 0, PLAN_HOLDS, PLAN_BREAKS, PLAN_FAILED } state;
    char text[PLAN_TEXT];       /**< "holds, 1.8 mm to Insula_L"; */
    char leeway[32];            /**< follows it: ", may be off by 0.66 mm". */
    char reaches[PLAN_TEXT];    /**< "Reaches U", "Does not reach U"; "" where nothing is to be reached. */
    char clears[PLAN_TEXT];     /**< "4.0 mm from Ball", "touches Ball"; "" where nothing is to be clear of it. */
    char details[PLAN_DETAILS]; /**< A line for each constraint; "" where it is unknown. */
};

/** The state of model/plans.h. */
struct plan_state {
    struct plan_task task;            /**< Does not change. */
    unsigned number;                  /**< Grows with every other task. */
    double depth;                     /**< Far end of candidates that have none; 0 = none. */
    struct study_state list;          /**< The candidates' study: STUDY_PLAN, or STUDY_NONE without a file of them. */
    conus_selector *selector;         /**< Selects for the plan that tries the tool; */
    conus_plan *live;                 /**< NULL = to be made. */
    conus_selector_options made_with; /**< That selector. */
    struct plan_verdict verdict;
    bool judged;           /**< There is a verdict, */
    unsigned judged_after; /**< at this answer_number of the tool. */
};

/** Ends the plan that tries the tool: its radius or its atlas is about to change. */
void plan_state_drop_live(struct plan_state *state);
/** Likewise, and lets nothing of the atlas be read until plan_state_resume(). */
void plan_state_pause(struct plan_state *state);
void plan_state_resume(struct plan_state *state);
/** Forgets the list, and the thread that makes it: the atlas is another one. */
void plan_state_forget(struct plan_state *state);
void plan_state_finish(struct plan_state *state);

#endif
