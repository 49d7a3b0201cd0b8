/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A list that shaders append to: a storage buffer
 *
 *     layout(std430, binding = ...) restrict buffer List { uint count; uint unused; Record records[]; };
 *
 * in which a fragment takes the place atomicAdd(count, 1u) and writes its record if that is below records.length().
 * A draw that appends more records than the capacity is repeated, with a larger capacity or for fewer pixels at once.
 * So the list on the device stays small. Needs a current context throughout. */
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
};

/** One drawing into a list. Both functions get @p user. */
struct shader_list_job {
    GLuint binding;
    /** Draws pixels number @p first to @p end - 1; nothing else may write to the list. */
    conus_status (*draw)(void *user, uint32_t first, uint32_t end);
    /** Takes the records of these pixels in any order; those of one shader keep theirs. */
    conus_status (*take)(void *user, const void *records, uint32_t count);
    void *user;
    uint32_t pixels;    /**< Number of pixels.                                  */
    uint32_t per_pixel; /**< No pixel appends more records; 0 = there are none. */
};

/** An empty list of records of @p record_size bytes; @p first of them fit before it grows. */
conus_status shader_list_init(struct shader_list *out, size_t record_size, uint32_t first);
void shader_list_finish(struct shader_list *list);

/** Draws and takes until all pixels are done. */
conus_status shader_list_collect(struct shader_list *list, const struct shader_list_job *job);

#endif
