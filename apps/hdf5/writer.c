/* SPDX-License-Identifier: BSD-3-Clause */
/* The stream of frames on stdout. */
#include "conus_hdf5.h"

#include "base/system/system.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t left;   /* bytes that the stream may still have */
static uint64_t frames; /* that were written */

static const uint8_t zeros[8] = {0};

static void put(const void *data, size_t size)
{
    if (size && fwrite(data, 1, size, stdout) != size) {
        perror("standard output");
        exit(1);
    }
}

static void put_number(uint64_t value, size_t size)
{
    uint8_t bytes[8];
    for (size_t i = 0; i < size; i++) {
        bytes[i] = (uint8_t)(value >> 8 * i);
    }
    put(bytes, size);
}

static size_t padding(uint64_t size)
{
    return (size_t)(-size & 7);
}

static void put_frame(const struct description *what, uint64_t size)
{
    size_t name = strlen(what->name);
    put_number(what->kind, 4);
    put_number(what->class, 4);
    put_number(what->size, 4);
    put_number(what->rank, 4);
    put_number(what->address, 8);
    for (size_t i = 0; i < HDF5_RANK_LIMIT; i++) {
        put_number(what->dims[i], 8);
    }
    put_number(name, 4);
    put_number(0, 4);
    put_number(size, 8);
    put(what->name, name);
    put(zeros, padding(name));
    frames++;
}

void stream_begin(uint64_t limit)
{
    left = limit;
    put(HDF5_STREAM_MAGIC, HDF5_MAGIC_SIZE);
}

uint64_t stream_left(void)
{
    return left;
}

void stream_frame(const struct description *what, uint64_t size)
{
    uint64_t needed = HDF5_FRAME_HEADER_SIZE + strlen(what->name) + 16 + size;
    if (frames == HDF5_FRAME_LIMIT) {
        refuse(true, "%s: more than %d objects and attributes", what->name, HDF5_FRAME_LIMIT);
    }
    if (needed < size || needed > left) {
        refuse(true, "%s: the %llu bytes that are left do not hold it (--max-memory)", what->name,
               (unsigned long long)left);
    }
    left -= needed;
    put_frame(what, size);
}

void stream_data(const void *data, size_t size)
{
    put(data, size);
}

void stream_pad(uint64_t size)
{
    put(zeros, padding(size));
}

static void put_last(enum hdf5_frame_kind kind, uint32_t rank, const char *words)
{
    const struct description last = {.kind = kind, .rank = rank, .address = frames, .name = words};
    put_frame(&last, 0);
    if (fflush(stdout)) {
        perror("standard output");
        exit(1);
    }
}

void stream_end(void)
{
    put_last(HDF5_FRAME_END, 0, "");
    _exit(0);
}

void refuse(bool is_limit, const char *format, ...)
{
    char words[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    put_last(HDF5_FRAME_FAILURE, is_limit, words);
    _exit(0); /* without libhdf5's own end, which a damaged file may have made a crash of */
}

/* The innermost of libhdf5's errors. */
static herr_t take_first(unsigned depth, const H5E_error2_t *error, void *user)
{
    if (depth == 0 && error->desc) {
        snprintf(user, 200, ": %s", error->desc);
    }
    return 0;
}

void refuse_damaged(const char *path, const char *action)
{
    char why[200] = "";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, why);
    refuse(false, "%s: cannot %s%s", path, action, why);
}
