/* SPDX-License-Identifier: BSD-3-Clause */
/* A thread that makes a field, then its texels, some slices at a time, ahead of who takes them. */
#include "render/colour/field_task.h"

#include "base/memory.h"

#include <signal.h>

/* Slabs of so many texels stay in the processor's cache; and so many are made ahead. */
enum { SLAB_TEXELS = 1 << 17, SLABS = 16 };

static size_t slice_of(const struct field *field)
{
    return field->dim[0] * field->dim[1];
}

/* Slices of a slab. */
static size_t step_of(const struct field *field)
{
    return SLAB_TEXELS / slice_of(field) + 1;
}

/* Its place among the texels in memory, and the slices. The count is 0 behind the last. */
static uint8_t *place_slab(struct field_slab *out, const struct field_task *task, size_t number)
{
    size_t step = step_of(&task->field);
    size_t slot = task->has_thread ? number % SLABS : 0;
    uint8_t *place = task->texels + 4 * slot * step * slice_of(&task->field);
    size_t left = task->field.dim[2] > number * step ? task->field.dim[2] - number * step : 0;
    *out = (struct field_slab){.texels = place, .first = number * step, .count = left < step ? left : step};
    return place;
}

static conus_status make(struct field_task *task)
{
    conus_status status = task->is_values ? field_of_values(&task->field, task->volume, &task->scale)
                                          : field_of_objects(&task->field, task->volume);
    if (!status) {
        size_t slabs = task->has_thread ? SLABS : 1;
        task->texels = memory_raw(slabs * step_of(&task->field) * slice_of(&task->field), 4);
    }
    return status || task->texels ? status : CONUS_ERROR_MEMORY;
}

/* Whether there is room for another slab, as there is sooner or later unless nobody wants any. */
static bool wait_for_room(struct field_task *task)
{
    pthread_mutex_lock(&task->lock);
    while (!task->stop && task->ready - task->released == SLABS) {
        pthread_cond_wait(&task->changed, &task->lock);
    }
    bool goes_on = !task->stop;
    pthread_mutex_unlock(&task->lock);
    return goes_on;
}

static void *run(void *user)
{
    struct field_task *task = user;
    struct field_slab slab;
    conus_status status = make(task);
    pthread_mutex_lock(&task->lock);
    task->status = status;
    task->is_made = true;
    pthread_cond_signal(&task->changed);
    pthread_mutex_unlock(&task->lock);
    for (size_t n = 0; !status && wait_for_room(task); n++) {
        uint8_t *place = place_slab(&slab, task, n);
        if (!slab.count) {
            break;
        }
        field_texels(place, &task->field, slab.first, slab.count);
        pthread_mutex_lock(&task->lock);
        task->ready++;
        pthread_cond_signal(&task->changed);
        pthread_mutex_unlock(&task->lock);
    }
    return NULL;
}

/* Signals are for the program's own threads. The thread reads has_thread. */
void field_task_start(struct field_task *task)
{
    sigset_t all;
    sigset_t before;
    if (!task->volume) {
        return;
    }
    pthread_mutex_init(&task->lock, NULL);
    pthread_cond_init(&task->changed, NULL);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    task->has_thread = true;
    if (pthread_create(&task->thread, NULL, run, task)) {
        task->has_thread = false;
        pthread_cond_destroy(&task->changed);
        pthread_mutex_destroy(&task->lock);
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/* Messages of failures are the thread's that fails. */
conus_status field_task_wait(const struct field **out, struct field_task *task)
{
    if (!task->has_thread) {
        task->status = make(task);
    } else {
        pthread_mutex_lock(&task->lock);
        while (!task->is_made) {
            pthread_cond_wait(&task->changed, &task->lock);
        }
        pthread_mutex_unlock(&task->lock);
        if (task->status) {
            return fail(task->status, "no memory for the field of a volume");
        }
    }
    *out = task->status ? *out : &task->field;
    return task->status;
}

/* The one before may be written over from now on. */
static void wait_for_slab(struct field_task *task, size_t number)
{
    pthread_mutex_lock(&task->lock);
    task->released = number;
    pthread_cond_signal(&task->changed);
    while (task->ready <= number) {
        pthread_cond_wait(&task->changed, &task->lock);
    }
    pthread_mutex_unlock(&task->lock);
}

bool field_task_next(struct field_slab *out, struct field_task *task)
{
    struct field_slab slab;
    uint8_t *place = place_slab(&slab, task, task->taken);
    if (!slab.count) {
        return false;
    }
    if (task->has_thread) {
        wait_for_slab(task, task->taken);
    } else {
        field_texels(place, &task->field, slab.first, slab.count);
    }
    task->taken++;
    *out = slab;
    return true;
}

void field_task_end(struct field_task *task)
{
    if (task->has_thread) {
        pthread_mutex_lock(&task->lock);
        task->stop = true;
        pthread_cond_signal(&task->changed);
        pthread_mutex_unlock(&task->lock);
        pthread_join(task->thread, NULL);
        pthread_cond_destroy(&task->changed);
        pthread_mutex_destroy(&task->lock);
        task->has_thread = false;
    }
    field_finish(&task->field);
    memory_free(task->texels);
    task->texels = NULL;
}
