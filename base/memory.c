/* SPDX-License-Identifier: BSD-3-Clause */
/* Allocation with checked sizes. */
#include "base/memory.h"

#include "base/status.h"
#include "base/system/system.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void *check_block(void *block, size_t count, size_t size)
{
    if (!block) {
        fail(CONUS_ERROR_MEMORY, "no memory for %zu elements of %zu bytes", count, size);
    }
    return block;
}

void *memory_zeroed(size_t count, size_t size)
{
    return check_block(calloc(count ? count : 1, size ? size : 1), count, size);
}

void *memory_sparse(size_t size)
{
    uint8_t *block = memory_zeroed(size, 1);
    if (block) {
        system_make_sparse(block, size);
    }
    return block;
}

void *memory_raw(size_t count, size_t size)
{
    size_t bytes;
    bool fits = memory_multiply(count, size, &bytes);
    return check_block(fits ? malloc(bytes ? bytes : 1) : NULL, count, size);
}

void *memory_resize(void *block, size_t count, size_t size)
{
    size_t bytes;
    bool fits = memory_multiply(count, size, &bytes);
    return check_block(fits ? realloc(block, bytes ? bytes : 1) : NULL, count, size);
}

void *memory_copy(const void *block, size_t count, size_t size)
{
    void *copy = memory_raw(count, size);
    if (copy && count) {
        memcpy(copy, block, count * size);
    }
    return copy;
}

bool memory_reserve(void *array, size_t *capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return true;
    }
    size_t wanted = count > 2 * *capacity ? count : 2 * *capacity;
    void *block;
    memcpy(&block, array, sizeof block); /* a pointer of another type must not be read as void * */
    void *larger = memory_resize(block, wanted, size);
    if (larger) {
        memcpy(array, &larger, sizeof larger);
        *capacity = wanted;
    }
    return larger;
}

char *memory_text(const char *text, size_t length)
{
    char *copy = memory_raw(length + 1, 1);
    if (copy) {
        if (length) {
            memcpy(copy, text, length);
        }
        copy[length] = '\0';
    }
    return copy;
}

void memory_free(void *block)
{
    free(block);
}
