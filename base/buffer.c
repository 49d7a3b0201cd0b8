/* SPDX-License-Identifier: BSD-3-Clause */
/* Growable text and bytes. */
#include "base/memory.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void buffer_finish(struct buffer *buffer)
{
    memory_free(buffer->data);
    *buffer = (struct buffer){0};
}

/* Grows by `more` bytes and a NUL; doubles, so that appending n bytes costs O(n). */
static bool reserve_bytes(struct buffer *buffer, size_t more)
{
    size_t needed;
    if (buffer->failed || __builtin_add_overflow(buffer->size, more, &needed) || needed == SIZE_MAX) {
        buffer->failed = true;
        return false;
    }
    if (needed + 1 <= buffer->capacity) {
        return true;
    }
    size_t capacity = buffer->capacity < SIZE_MAX / 2 ? 2 * buffer->capacity : needed + 1;
    capacity = capacity < needed + 1 ? needed + 1 : capacity;
    char *data = memory_resize(buffer->data, capacity, 1);
    if (!data) {
        buffer->failed = true;
        return false;
    }
    buffer->data = data;
    buffer->capacity = capacity;
    return true;
}

static bool has_room(const struct buffer *buffer, size_t more)
{
    return !buffer->failed && more < buffer->capacity - buffer->size;
}

void buffer_append_more(struct buffer *buffer, const void *bytes, size_t size)
{
    if (!reserve_bytes(buffer, size)) {
        return;
    }
    if (size) {
        memcpy(buffer->data + buffer->size, bytes, size);
    }
    buffer->size += size;
    buffer->data[buffer->size] = '\0';
}

void buffer_text(struct buffer *buffer, const char *text)
{
    buffer_append(buffer, text, strlen(text));
}

void buffer_xml(struct buffer *buffer, const char *text)
{
    for (const char *c = text; *c; c++) {
        bool is_none = strncmp(c, "\xef\xbf\xbe", 3) == 0 || strncmp(c, "\xef\xbf\xbf", 3) == 0; /* U+FFFE, U+FFFF */
        bool is_control = (unsigned char)*c < ' ' && !strchr("\t\n\r", *c);
        const char *stands = *c == '&'               ? "&amp;"
                             : *c == '<'             ? "&lt;"
                             : *c == '>'             ? "&gt;"
                             : *c == '"'             ? "&quot;"
                             : is_none || is_control ? "\xef\xbf\xbd"
                                                     : NULL;
        buffer_append(buffer, stands ? stands : c, stands ? strlen(stands) : 1);
        c += is_none ? 2 : 0;
    }
}

void buffer_format(struct buffer *buffer, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length < 0 || !reserve_bytes(buffer, (size_t)length)) {
        buffer->failed = true;
        return;
    }
    va_start(args, format);
    vsnprintf(buffer->data + buffer->size, (size_t)length + 1, format, args);
    va_end(args);
    buffer->size += (size_t)length;
}

void buffer_number(struct buffer *buffer, double value)
{
    if (has_room(buffer, TEXT_NUMBER_SIZE) || reserve_bytes(buffer, TEXT_NUMBER_SIZE)) {
        buffer->size += text_number_length(buffer->data + buffer->size, value);
    }
}

void buffer_whole(struct buffer *buffer, uint64_t value)
{
    if (has_room(buffer, TEXT_NUMBER_SIZE) || reserve_bytes(buffer, TEXT_NUMBER_SIZE)) {
        buffer->size += text_whole(buffer->data + buffer->size, value);
    }
}

void buffer_clear(struct buffer *buffer)
{
    buffer->size = 0;
}

conus_status buffer_status(const struct buffer *buffer)
{
    return buffer->failed ? fail(CONUS_ERROR_MEMORY, "no memory for a text of %zu bytes", buffer->size) : CONUS_OK;
}
