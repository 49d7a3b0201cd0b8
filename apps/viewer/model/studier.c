/* SPDX-License-Identifier: BSD-3-Clause */
/* The thread of studies: the newest question, one answer at a time. */
#include "viewer/model/study.h"

#include "base/system/system.h"
#include "options/progress.h"
#include "viewer/model/viewer.h"

#include <pthread.h>
#include <stdlib.h>

/* Studies shall not hold up the window or its pictures, where they share processors. */
static const int niceness = 4;
/* A study that has taken longer is ended for a newer question; a quicker one keeps up with a moving cone. */
static const double patience_ms = 300;

struct studier {
    pthread_t thread;
    pthread_mutex_t lock; /* guards what follows */
    pthread_cond_t wake, rest;
    bool stop;
    bool is_new;    /* asked has not been begun */
    bool is_busy;   /* reads the atlases */
    unsigned holds; /* the atlases are about to change, or do */
    struct study_question asked;
    double begun;               /* when the one under way was, by clock_ms() */
    struct study_answer *done;  /* NULL = none, or taken */
    conus_selector **selectors; /* [atlas_count] The thread's own; */
    struct study_question of;   /* made for this one, */
    bool has_selectors;         /* if there are any. */

    /* as they were given */
    const struct view_atlas *atlases;
    size_t atlas_count;
    void (*wake_window)(void);
};

static void drop_selectors(struct studier *studier)
{
    for (size_t i = 0; i < studier->atlas_count; i++) {
        conus_selector_destroy(studier->selectors[i]);
        studier->selectors[i] = NULL;
    }
    studier->has_selectors = false;
}

static conus_status prepare_selectors(struct studier *studier, const struct study_question *question)
{
    conus_status status = CONUS_OK;
    if (studier->has_selectors && study_has_same_selectors(&studier->of, question)) {
        return CONUS_OK;
    }
    drop_selectors(studier);
    studier->of = *question;
    studier->has_selectors = true;
    for (size_t i = 0; i < studier->atlas_count && !status; i++) {
        conus_selector_options options = question->options;
        options.level = question->level[0] && !i ? question->level : NULL;
        options.frame = &question->frame; /* a table's is that of its report */
        status = conus_selector_create(&studier->selectors[i], studier->atlases[i].atlas, &options);
    }
    return status;
}

static bool is_to_stop(void *user)
{
    struct studier *studier = user;
    pthread_mutex_lock(&studier->lock);
    bool stops = studier->stop || studier->holds || (studier->is_new && clock_ms() - studier->begun > patience_ms);
    pthread_mutex_unlock(&studier->lock);
    return stops;
}

static struct study_answer *answer(struct studier *studier, const struct study_question *question)
{
    if (question->settings.kind == STUDY_SWEEP && question->options.radius > 0) {
        return study_answer_refuse(question, "a cylinder has no angle to sweep");
    }
    conus_status status = prepare_selectors(studier, question);
    if (status) {
        drop_selectors(studier);
        return study_answer_refuse(question, status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
    }
    return study_answer_create(question, studier->selectors, studier->atlases, studier->atlas_count, is_to_stop,
                               studier);
}

/* Waits for a question. To be called with the lock held. False: stop. */
static bool wait_for_work(struct studier *studier)
{
    while (!studier->stop && (studier->holds || !studier->is_new)) {
        if (studier->holds && studier->has_selectors) { /* they know the atlases as they were */
            drop_selectors(studier);
        }
        studier->is_busy = false;
        pthread_cond_broadcast(&studier->rest);
        pthread_cond_wait(&studier->wake, &studier->lock);
    }
    return !studier->stop;
}

/* Answers the newest question. To be called with the lock held, which it releases while it computes. */
static void answer_newest(struct studier *studier)
{
    const struct study_question question = studier->asked;
    studier->is_new = false;
    studier->is_busy = true;
    studier->begun = clock_ms();
    pthread_mutex_unlock(&studier->lock);
    struct study_answer *found = answer(studier, &question);
    pthread_mutex_lock(&studier->lock);
    if (!found) {
        studier->is_new = studier->is_new || studier->stop || studier->holds; /* else there is no memory */
        return;
    }
    study_answer_destroy(studier->done);
    studier->done = found;
    if (studier->wake_window) {
        studier->wake_window();
    }
}

static void *run(void *user)
{
    struct studier *studier = user;
    system_step_back(niceness); /* this thread */
    pthread_mutex_lock(&studier->lock);
    while (wait_for_work(studier)) {
        answer_newest(studier);
    }
    drop_selectors(studier); /* on the thread that made them, as gl needs it */
    pthread_mutex_unlock(&studier->lock);
    return NULL;
}

static void finish(struct studier *studier)
{
    pthread_mutex_destroy(&studier->lock);
    pthread_cond_destroy(&studier->wake);
    pthread_cond_destroy(&studier->rest);
    study_answer_destroy(studier->done);
    free((void *)studier->selectors);
    free(studier);
}

bool studier_create(struct studier **out, const struct view_atlas *atlases, size_t count, void (*wake)(void))
{
    struct studier *studier = calloc(1, sizeof *studier);
    if (!studier) {
        return false;
    }
    *studier = (struct studier){.lock = PTHREAD_MUTEX_INITIALIZER,
                                .wake = PTHREAD_COND_INITIALIZER,
                                .rest = PTHREAD_COND_INITIALIZER,
                                .atlases = atlases,
                                .selectors = calloc(count, sizeof(conus_selector *)),
                                .atlas_count = count,
                                .wake_window = wake};
    if (!studier->selectors || pthread_create(&studier->thread, NULL, run, studier)) {
        finish(studier);
        return false;
    }
    *out = studier;
    return true;
}

void studier_destroy(struct studier *studier)
{
    if (studier) {
        pthread_mutex_lock(&studier->lock);
        studier->stop = true;
        pthread_cond_signal(&studier->wake);
        pthread_mutex_unlock(&studier->lock);
        pthread_join(studier->thread, NULL);
        finish(studier);
    }
}

void studier_ask(struct studier *studier, const struct study_question *question)
{
    if (studier) {
        pthread_mutex_lock(&studier->lock);
        studier->asked = *question;
        studier->is_new = true;
        pthread_cond_signal(&studier->wake);
        pthread_mutex_unlock(&studier->lock);
    }
}

struct study_answer *studier_take(struct studier *studier)
{
    struct study_answer *taken = NULL;
    if (studier) {
        pthread_mutex_lock(&studier->lock);
        taken = studier->done;
        studier->done = NULL;
        pthread_mutex_unlock(&studier->lock);
    }
    return taken;
}

void studier_hold(struct studier *studier)
{
    if (studier) {
        pthread_mutex_lock(&studier->lock);
        studier->holds++;
        pthread_cond_signal(&studier->wake);
        while (studier->is_busy || studier->has_selectors) {
            pthread_cond_wait(&studier->rest, &studier->lock);
        }
        pthread_mutex_unlock(&studier->lock);
    }
}

void studier_resume(struct studier *studier)
{
    if (studier) {
        pthread_mutex_lock(&studier->lock);
        studier->holds--;
        pthread_cond_signal(&studier->wake);
        pthread_mutex_unlock(&studier->lock);
    }
}
