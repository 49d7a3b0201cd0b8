/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Fields and their texels, which are made on threads of their own, while the caller's thread prepares OpenGL and
 * uploads those that are ready. */
#ifndef CONUS_RENDER_COLOUR_FIELD_TASK_H
#define CONUS_RENDER_COLOUR_FIELD_TASK_H

#include "render/colour/field.h"

#include <pthread.h>

/** Some slices of texels (field_texels()). */
struct field_slab {
    const uint8_t *texels;
    size_t first, count; /**< Slices. */
};

/** One field. Zeroed, it is of nothing. */
struct field_task {
    const struct volume *volume; /**< NULL = of nothing. */
    bool is_values;              /**< Of grey values, by `scale`; else of objects. */
    struct field_scale scale;
    size_t taken; /**< Slabs; the caller's thread's own. */
    bool has_thread;
    pthread_t thread;
    pthread_mutex_t lock;   /**< Where there is a thread: guards what follows. */
    pthread_cond_t changed; /**< Some of it did. */
    bool is_made, stop;
    conus_status status;
    struct field field;
    uint8_t *texels;        /**< Those of some slabs. */
    size_t ready, released; /**< Slabs that have been made, and of these, that may be written over. */
};

/** Begins to make the field of @p task, whose volume is read until field_task_end(). */
void field_task_start(struct field_task *task);

/** Waits for the field, which is the task's; made here where nothing began. CONUS_ERROR_MEMORY. */
conus_status field_task_wait(const struct field **out, struct field_task *task);

/** After field_task_wait(): the next slices, from the first on, which stay until the next call; false behind the last.
 */
bool field_task_next(struct field_slab *out, struct field_task *task);

/** Ends what is under way, and drops it. */
void field_task_end(struct field_task *task);

#endif
