/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Growable text or bytes. Appending never reports: a failed buffer stays failed, and buffer_status() says so at the
 * end, so that a writer is a straight line of appends. */
#ifndef CONUS_BASE_BUFFER_H
#define CONUS_BASE_BUFFER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

#endif
