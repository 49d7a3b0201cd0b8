/* SPDX-License-Identifier: BSD-3-Clause */
/* The memory of a libhdf5 that scripts/libraries has built, which takes it from here: macOS, Windows and qemu have no
 * limits of space, or none that was seen to hold. */
#include "memory_limit.h"

#include <stdlib.h>
#include <string.h>

/* What stands before each piece. */
union head {
    size_t size;
    max_align_t align;
};

static uint64_t used;                 /* bytes of libhdf5's */
static uint64_t allowed = UINT64_MAX; /* that it may use; until memory_allow() all */

void memory_allow(uint64_t bytes)
{
    uint64_t before = allowed == UINT64_MAX ? used : allowed;
    allowed = bytes < UINT64_MAX - before ? before + bytes : UINT64_MAX - 1;
}

void *counted_resize(void *memory, size_t size)
{
    union head *old = memory ? (union head *)memory - 1 : NULL;
    uint64_t others = used - (old ? old->size : 0);
    if (size > SIZE_MAX - sizeof *old || others > allowed || size > allowed - others) {
        return NULL;
    }
    union head *head = realloc(old, sizeof *head + size);
    if (!head) {
        return NULL;
    }
    head->size = size;
    used = others + size;
    return head + 1;
}

void *counted_zeros(size_t count, size_t size)
{
    size_t bytes;
    void *memory = __builtin_mul_overflow(count, size, &bytes) ? NULL : counted_resize(NULL, bytes);
    if (memory) {
        memset(memory, 0, bytes);
    }
    return memory;
}

char *counted_text(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = counted_resize(NULL, size);
    return copy ? memcpy(copy, text, size) : NULL;
}

void counted_free(void *memory)
{
    if (memory) {
        union head *head = (union head *)memory - 1;
        used -= head->size;
        free(head);
    }
}
