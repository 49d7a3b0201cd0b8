/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of the walk that packs an atlas and takes it out again. */
#include "selection/batch/pack_walk.h"

#include "base/memory.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

conus_status pack_fail_damaged(void)
{
    return fail(CONUS_ERROR_DATA, "the memory holds no atlas that this version of conus has packed");
}

void pack_bytes(struct pack_walk *walk, void *data, size_t size)
{
    if (walk->status) {
        return;
    }
    if (walk->mode == PACK_ATTACH && size > walk->small_end - walk->small) {
        walk->status = pack_fail_damaged();
        return;
    }
    if (walk->mode == PACK_COPY || walk->mode == PACK_WRITE) {
        memcpy(walk->memory + walk->small, data, size);
    } else if (walk->mode == PACK_ATTACH) {
        memcpy(data, walk->memory + walk->small, size);
    }
    walk->small += size;
}

void pack_text(struct pack_walk *walk, char **text)
{
    char *given = *text;
    size_t size = walk->mode != PACK_ATTACH && given ? strlen(given) + 1 : 0;
    if (walk->mode == PACK_ATTACH) {
        *text = NULL;
    }
    pack_bytes(walk, &size, sizeof size);
    if (walk->status || size == 0) {
        return;
    }
    if (walk->mode == PACK_ATTACH) {
        bool fits = size <= walk->small_end - walk->small;
        *text = fits ? memory_text((const char *)walk->memory + walk->small, size - 1) : NULL;
        walk->status = !fits ? pack_fail_damaged() : *text ? CONUS_OK : CONUS_ERROR_MEMORY;
        walk->small += size;
    } else {
        pack_bytes(walk, given, size);
    }
}

uint8_t *pack_place(struct pack_walk *walk, size_t size)
{
    size_t at = walk->large;
    bool in_memory = walk->mode == PACK_COPY || walk->mode == PACK_ATTACH;
    bool fits = walk->mode == PACK_MEASURE || (at <= walk->size && size <= walk->size - at);
    if (walk->status) {
        return NULL;
    }
    if (!fits) {
        walk->status = pack_fail_damaged();
        return NULL;
    }
    walk->large += (size + PACK_BEHIND + PACK_LINE - 1) / PACK_LINE * PACK_LINE;
    return in_memory ? walk->memory + at : NULL;
}

bool pack_whether(struct pack_walk *walk, const void *thing)
{
    uint8_t is_there = thing ? 1 : 0;
    pack_bytes(walk, &is_there, sizeof is_there);
    return is_there;
}

void pack_write_at(struct pack_walk *walk, size_t at, const uint8_t *data, size_t size)
{
    while (!walk->status && size) {
        ssize_t n = pwrite(walk->file, data, size, (off_t)(walk->file_at + at));
        if (n < 0 && errno != EINTR) {
            walk->status = fail(CONUS_ERROR_IO, "cannot write a packed atlas: %s", strerror(errno));
        }
        size_t done = n > 0 ? (size_t)n : 0;
        data += done;
        at += done;
        size -= done;
    }
}

void pack_array(struct pack_walk *walk, void *array, size_t count, size_t size)
{
    void *given;
    size_t bytes = 0;
    memcpy(&given, array, sizeof given);
    bool is_there = pack_whether(walk, given);
    if (!walk->status && !memory_multiply(count, size, &bytes)) {
        walk->status = pack_fail_damaged();
    }
    size_t at = walk->large;
    uint8_t *place = is_there && !walk->status ? pack_place(walk, bytes) : NULL;
    if (place && walk->mode == PACK_COPY) {
        memcpy(place, given, bytes);
    } else if (is_there && walk->mode == PACK_WRITE) {
        pack_write_at(walk, at, given, walk->status ? 0 : bytes);
    } else if (walk->mode == PACK_ATTACH) {
        memcpy(array, &place, sizeof place);
    }
}

void *pack_reserve(struct pack_walk *walk, void *things, size_t count, size_t size)
{
    size_t capacity = 1;
    if (walk->mode != PACK_ATTACH || walk->status) {
        return things;
    }
    if (count > walk->small_end) { /* each takes a byte at least */
        walk->status = pack_fail_damaged();
        return things;
    }
    while (capacity < count) {
        capacity *= 2;
    }
    things = memory_zeroed(capacity, size);
    walk->status = things ? CONUS_OK : CONUS_ERROR_MEMORY;
    return things;
}
