/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A list that shaders append to: a storage buffer
 *
 *     layout(std430, binding = ...) restrict buffer List { uint count; uint unused; Record records[]; };
 *
 * in which a fragment takes the place atomicAdd(count, 1u) and writes its record if that is below records.length().
 * A draw that appends more records than the capacity is repeated, with a larger capacity or for fewer pixels at once.
 * So the list on the device stays small. Needs a current context throughout. To draw:
 *
 *     shader_list_begin();
 *     while (shader_list_next()) { draw those pixels; shader_list_read(); take the records; } */
#ifndef CONUS_RENDER_GL_SHADER_LIST_H
#define CONUS_RENDER_GL_SHADER_LIST_H

#include "render/gl/readback.h"

struct shader_list {
    GLuint buffer;
    size_t record_size; /**< Bytes. */
    uint32_t capacity;  /**< Records that fit.                            */
    uint32_t limit;     /**< The largest capacity.                         */
    uint32_t likely;    /**< Records that are read before it is known how many there are. */
    struct readback readback;
    uint32_t first, end; /**< Pixels that are drawn now. */
    uint32_t pixels;     /**< In all. */
    uint32_t together;   /**< So many are drawn at once. */
};

/** An empty list of records of @p record_size bytes; @p first of them fit before it grows. */
conus_status shader_list_init(struct shader_list *out, size_t record_size, uint32_t first);
void shader_list_finish(struct shader_list *list);

/** Begins to draw @p pixels pixels, none of which appends more than @p per_pixel records. */
void shader_list_begin(struct shader_list *list, uint32_t pixels, uint32_t per_pixel);

/** Whether there are more: then an empty list is bound to @p binding for pixels number list->first to list->end - 1. */
bool shader_list_next(struct shader_list *list, GLuint binding);

/** Reads the @p count records that these have appended, in any order, but those of one shader in theirs. They are
 * borrowed until the next call. None are told where they did not fit: the pixels come again. */
conus_status shader_list_read(struct shader_list *list, const void **records, uint32_t *count);

#endif
