/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Fields that are made on threads of their own, while the caller's thread prepares OpenGL. */
#ifndef CONUS_RENDER_COLOUR_FIELD_TASK_H
#define CONUS_RENDER_COLOUR_FIELD_TASK_H

#include "render/colour/field.h"

#include <pthread.h>

/** One field. Zeroed, it is of nothing. */
struct field_task {
    const struct volume *volume; /**< NULL = of nothing. */
    bool is_values;              /**< Of grey values from low to high; else of objects. */
    double low, high;
    bool has_thread;
    pthread_t thread;
    conus_status status;
    struct field field;
};

/** Begins to make the field of @p task, whose volume is read until field_task_end(). */
void field_task_start(struct field_task *task);

/** Waits for the field, which is the caller's to field_finish(); made here where nothing began. CONUS_ERROR_MEMORY. */
conus_status field_task_take(struct field *out, struct field_task *task);

/** Waits for what is left, and drops it. */
void field_task_end(struct field_task *task);

#endif
