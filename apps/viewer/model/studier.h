/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A thread that answers the newest study while the window goes on. It has selectors of its own. */
#ifndef CONUS_VIEWER_MODEL_STUDIER_H
#define CONUS_VIEWER_MODEL_STUDIER_H

#include "viewer/model/study.h"

struct studier;

/** The state of model/studies.h. */
struct study_state {
    struct study_settings settings;
    struct studier *studier;     /**< Made when needed. */
    struct study_question asked; /**< The newest one, if there is a studier. */
    struct study_answer *answer; /**< The newest one; NULL = none. */
};

/** The atlases [count] and their names must outlive it; @p wake (NULL = nothing) is called on its thread when there is
 * an answer. False without memory or a thread. */
bool studier_create(struct studier **out, const struct view_atlas *atlases, size_t count, void (*wake)(void));
/** Waits for the portion that is being computed. NULL is allowed, here and below. */
void studier_destroy(struct studier *studier);

/** Asks for a study in place of those asked before; the one under way is ended, unless it takes less than 0.3 s. */
void studier_ask(struct studier *studier, const struct study_question *question);
/** The newest answer, now the caller's to destroy; NULL = there is no other than before. */
struct study_answer *studier_take(struct studier *studier);

/** Waits until nothing of the atlases is read, and lets nothing be read, until as many calls of studier_resume(). */
void studier_hold(struct studier *studier);
void studier_resume(struct studier *studier);

#endif
