/* SPDX-License-Identifier: BSD-3-Clause */
/* Ends what a plan reads from its atlas. */
#include "viewer/model/study.h"

#include <stdlib.h>

void plan_state_drop_live(struct plan_state *state)
{
    conus_plan_destroy(state->live);
    conus_selector_destroy(state->selector);
    state->live = NULL;
    state->selector = NULL;
}

void plan_state_pause(struct plan_state *state)
{
    plan_state_drop_live(state);
    studier_hold(state->list.studier);
}

void plan_state_resume(struct plan_state *state)
{
    studier_resume(state->list.studier);
}

void plan_state_forget(struct plan_state *state)
{
    studier_destroy(state->list.studier);
    study_answer_destroy(state->list.answer);
    state->list.studier = NULL;
    state->list.answer = NULL;
}

void plan_state_finish(struct plan_state *state)
{
    plan_state_drop_live(state);
    plan_state_forget(state);
    constraints_finish(&state->task.constraints);
    free(state->task.poses);
}
