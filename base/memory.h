/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Memory: the one allocator, text or bytes that grow, and a set of names. */
#ifndef CONUS_BASE_MEMORY_H
#define CONUS_BASE_MEMORY_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* The only place of the library that calls malloc: sizes are multiplied with a check, failure sets the message, and
 * the tests make the n-th call fail by wrapping malloc, calloc and realloc. */

/** @p count zeroed elements of @p size bytes; NULL with a message when it overflows or there is no memory.
 * Zero elements give a valid pointer. End it with memory_free(). */
void *memory_zeroed(size_t count, size_t size);

/** The same, not zeroed: for big arrays that are written whole. */
void *memory_raw(size_t count, size_t size);

/** @p size bytes of zeros. Only the parts that are written to take memory: by the system's smallest pages. */
void *memory_sparse(size_t size);

/** Resizes @p block to @p count elements of @p size bytes; NULL (and @p block as it was) on failure. */
void *memory_resize(void *block, size_t count, size_t size);

/** A copy of @p count elements of @p size bytes. */
void *memory_copy(const void *block, size_t count, size_t size);

/** @p array points to a pointer to elements, of any type. Grows it to a capacity of @p count elements or more. It at
 * least doubles *capacity, so that n elements added one by one cost O(n). False (all as it was) without memory. */
bool memory_reserve(void *array, size_t *capacity, size_t count, size_t size);

/** A copy of @p length bytes of @p text with a final NUL. */
char *memory_text(const char *text, size_t length);

/** Frees; NULL is fine. */
void memory_free(void *block);

/** The bytes of memory that a caller allows: @p max_memory of its options, where 0 means the default, 8 GiB. */
static inline uint64_t memory_limit(uint64_t max_memory)
{
    return max_memory ? max_memory : UINT64_C(8) << 30;
}

/** Whether chunks that unpack to @p chunks bytes together may stand for @p data bytes, of which they are to be cut:
 * chunks at the edges of an array are not full, and small arrays have one that is hardly filled. */
static inline bool memory_chunks_fit(double chunks, double data)
{
    return chunks <= 0x1p28 + 16 * data;
}

/** a * b into *product; false when it does not fit. */
static inline bool memory_multiply(size_t a, size_t b, size_t *product)
{
    return !__builtin_mul_overflow(a, b, product);
}

/* Growable text or bytes. Appending never reports: a failed buffer stays failed, and buffer_status() says so at the
 * end, so that a writer is a straight line of appends. */

struct buffer {
    char *data; /**< `size` bytes and a final NUL; NULL when nothing was appended. */
    size_t size;
    size_t capacity;
    bool failed; /**< An append found no memory. */
};

void buffer_finish(struct buffer *buffer);

/** buffer_append() where there may be no room. */
void buffer_append_more(struct buffer *buffer, const void *bytes, size_t size);

static inline void buffer_append(struct buffer *buffer, const void *bytes, size_t size)
{
    if (size == 0 || buffer->failed || size >= buffer->capacity - buffer->size) {
        buffer_append_more(buffer, bytes, size);
        return;
    }
    memcpy(buffer->data + buffer->size, bytes, size);
    buffer->size += size;
    buffer->data[buffer->size] = '\0';
}

void buffer_text(struct buffer *buffer, const char *text);
/** UTF-8 as text of XML, also in quotes; a character that XML does not have is U+FFFD. */
void buffer_xml(struct buffer *buffer, const char *text);
void buffer_format(struct buffer *buffer, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Appends @p value as text_number() writes it. */
void buffer_number(struct buffer *buffer, double value);

/** Appends @p value in decimal. */
void buffer_whole(struct buffer *buffer, uint64_t value);

/** Empties it and keeps its memory. A failed buffer stays failed. */
void buffer_clear(struct buffer *buffer);

/** CONUS_OK, or CONUS_ERROR_MEMORY when an append failed. */
conus_status buffer_status(const struct buffer *buffer);

/* A set of borrowed names: n of them are added and found in O(n log^2 n), whatever they are. A hash would be quicker
 * for most files, and slow for one that was made to be slow. */

struct known_name {
    const char *name; /**< Borrowed. */
    size_t value;     /**< The caller's number for it. */
};

/** Begins as all 0. The items are runs, each sorted: for each bit of `count` one of so many, the longest first. */
struct name_set {
    struct known_name *items;
    size_t count, capacity;
};

void name_set_finish(struct name_set *set);

/** An entry of @p name, whose value may be changed, or NULL. Valid until the next name is added. */
struct known_name *name_set_find(const struct name_set *set, const char *name);

/** Adds a name, even if it is there already. */
conus_status name_set_add(struct name_set *set, const char *name, size_t value);

#endif
