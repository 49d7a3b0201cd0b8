/* SPDX-License-Identifier: BSD-3-Clause */
/* Strings in chunks that are freed together. */
#include "poses/rows/pose_strings.h"

#include "base/memory.h"

#include <string.h>

enum { CHUNK = 16 * POSE_STRING_LIMIT };

struct pose_chunk {
    struct pose_chunk *next;
    size_t size;
    char data[CHUNK];
};

/* A chunk with a capacity for `size` bytes: the last one, the next that was kept, or a new one. */
static struct pose_chunk *chunk_for(struct pose_strings *strings, size_t size)
{
    struct pose_chunk *last = strings->last;
    if (last && last->size + size <= CHUNK) {
        return last;
    }
    struct pose_chunk *next = last ? last->next : strings->first;
    if (!next) {
        next = memory_raw(1, sizeof *next);
        if (!next) {
            return NULL;
        }
        next->next = NULL;
        *(last ? &last->next : &strings->first) = next;
    }
    next->size = 0;
    strings->last = next;
    return next;
}

const char *pose_strings_add(struct pose_strings *strings, struct text text)
{
    size_t size = text.size < POSE_STRING_LIMIT ? text.size : POSE_STRING_LIMIT - 1;
    struct pose_chunk *chunk = chunk_for(strings, size + 1);
    if (!chunk) {
        return NULL;
    }
    char *string = chunk->data + chunk->size;
    if (size) {
        memcpy(string, text.data, size);
    }
    string[size] = '\0';
    chunk->size += size + 1;
    return string;
}

void pose_strings_clear(struct pose_strings *strings)
{
    strings->last = NULL;
}

void pose_strings_finish(struct pose_strings *strings)
{
    for (struct pose_chunk *chunk = strings->first; chunk;) {
        struct pose_chunk *next = chunk->next;
        memory_free(chunk);
        chunk = next;
    }
    *strings = (struct pose_strings){0};
}
