/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The only place of the library that calls malloc: sizes are multiplied with a check, failure sets the
 * message, and the tests make the n-th call fail by wrapping malloc, calloc and realloc. */
#ifndef CONUS_BASE_MEMORY_H
#define CONUS_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

#endif
