/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One walk over an atlas that measures a block of memory, fills it, writes it to a file, or reads it.
 *
 * A function that passes a part of an atlas serves all of these: it gives each number, text and array to one of the
 * functions below, which counts it, puts it into the block, or takes it from there. After a failure they do nothing. */
#ifndef CONUS_SELECTION_BATCH_PACK_WALK_H
#define CONUS_SELECTION_BATCH_PACK_WALK_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PACK_LINE = 64, PACK_BEHIND = 64 }; /**< Where arrays begin, and bytes behind each that may be read. */

enum pack_mode { PACK_MEASURE, PACK_COPY, PACK_WRITE, PACK_ATTACH };

struct pack_walk {
    enum pack_mode mode;
    uint8_t *memory; /**< Read only when attaching, NULL when measuring; when writing, only what is small. */
    int file;        /**< When writing. */
    size_t file_at;  /**< Where the block begins in it. */
    size_t small, small_end;
    size_t large, size;
    conus_status status;
};

/** CONUS_ERROR_DATA, with its message. */
conus_status pack_fail_damaged(void);

/** What is small: @p size bytes at @p data, which are read, or written when attaching. */
void pack_bytes(struct pack_walk *walk, void *data, size_t size);

/** A text of its own, or none. */
void pack_text(struct pack_walk *walk, char **text);

/** Whether there is something. Not as a bool, which damage could make neither. */
bool pack_whether(struct pack_walk *walk, const void *thing);

/** Where the next @p size bytes of what is large lie; NULL when measuring or writing, and where there are none. */
uint8_t *pack_place(struct pack_walk *walk, size_t size);

/** Writes to where the block has @p at. */
void pack_write_at(struct pack_walk *walk, size_t at, const uint8_t *data, size_t size);

/** An array that stays in the block; @p array is the address of a pointer. Whether there is one is passed, too. */
void pack_array(struct pack_walk *walk, void *array, size_t count, size_t size);

/** Reserves memory for things that the atlas has by itself, up to the next power of two, as it does. */
void *pack_reserve(struct pack_walk *walk, void *things, size_t count, size_t size);

#endif
