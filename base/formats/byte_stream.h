/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The bytes of a file from its beginning to its end, block by block and unpacked where it is gzip, for what is too
 * large to be held twice. Checksums are verified, and the file's own sum is made on the way. */
#ifndef CONUS_BASE_FORMATS_BYTE_STREAM_H
#define CONUS_BASE_FORMATS_BYTE_STREAM_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BYTE_STREAM_BLOCK = 1 << 20 }; /**< Bytes that can be asked for at once. */

struct byte_source;

/** Messages are without the path, which the reader's caller puts in front. */
struct byte_stream {
    const uint8_t *data; /**< Bytes at hand, unpacked: those that come next. */
    size_t size;
    uint64_t position; /**< Unpacked bytes before `data`. */
    bool is_packed;    /**< The file is gzip. */
    struct byte_source *source;
};

/** Opens the regular file @p path. CONUS_ERROR_IO, CONUS_ERROR_MEMORY. End it with byte_stream_finish(). */
conus_status byte_stream_open(struct byte_stream *out, const char *path);

/** The same of @p size bytes at @p data, which are to outlive it. */
conus_status byte_stream_of(struct byte_stream *out, const uint8_t *data, size_t size);

void byte_stream_finish(struct byte_stream *stream);

/** Brings at least @p count bytes to hand, at most BYTE_STREAM_BLOCK; or all that are left, if they are fewer.
 * CONUS_ERROR_IO, CONUS_ERROR_DATA where gzip is damaged or cut off, or goes on behind its end. */
conus_status byte_stream_need(struct byte_stream *stream, size_t count);

/** Goes @p count bytes on, which are at hand. */
static inline void byte_stream_skip(struct byte_stream *stream, size_t count)
{
    stream->data += count;
    stream->size -= count;
    stream->position += count;
}

/** How many bytes can be left at most, those at hand included; exact of a file that is not packed. */
uint64_t byte_stream_most(const struct byte_stream *stream);

/** After byte_stream_need() found no byte left: the SHA-256 of the file, as it is stored, in hexadecimal.
 * CONUS_ERROR_IO where it changed meanwhile. */
conus_status byte_stream_sum(char out[65], struct byte_stream *stream);

#endif
