/* SPDX-License-Identifier: BSD-3-Clause */
/* A thread that makes a field. */
#include "render/colour/field_task.h"

#include <signal.h>

static conus_status make(struct field_task *task)
{
    return task->is_values ? field_of_values(&task->field, task->volume, task->low, task->high)
                           : field_of_objects(&task->field, task->volume);
}

static void *run(void *user)
{
    struct field_task *task = user;
    task->status = make(task);
    return NULL;
}

/* Signals are for the program's own threads. */
void field_task_start(struct field_task *task)
{
    sigset_t all;
    sigset_t before;
    if (!task->volume) {
        return;
    }
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    task->has_thread = pthread_create(&task->thread, NULL, run, task) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/* Messages of failures are the thread's that fails. */
static conus_status wait_for(struct field_task *task)
{
    if (!task->has_thread) {
        return CONUS_OK;
    }
    pthread_join(task->thread, NULL);
    task->has_thread = false;
    return task->status ? fail(task->status, "no memory for the field of a volume") : CONUS_OK;
}

conus_status field_task_take(struct field *out, struct field_task *task)
{
    conus_status status = task->has_thread ? wait_for(task) : make(task);
    if (!status) {
        *out = task->field;
        task->field = (struct field){0};
    }
    return status;
}

void field_task_end(struct field_task *task)
{
    wait_for(task);
    field_finish(&task->field);
}
