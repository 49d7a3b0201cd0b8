/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads lines in blocks of fixed size. */
#include "poses/rows/pose_lines.h"

#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>

enum { CAPACITY = 4 * (POSE_LINE_LIMIT + 1) };

static conus_status fail_to_read(void)
{
    return fail(CONUS_ERROR_IO, "cannot read: %s", text_error(errno));
}

conus_status pose_lines_init(struct pose_lines *lines, int descriptor, bool seekable, uint64_t offset)
{
    char *own = memory_raw(CAPACITY, 1);
    if (!own) {
        return CONUS_ERROR_MEMORY;
    }
    *lines = (struct pose_lines){.descriptor = descriptor,
                                 .seekable = seekable,
                                 .stop = {SYSTEM_NO_FILE},
                                 .offset = offset,
                                 .own = own,
                                 .data = own};
    sha256_init(&lines->hash);
    return !seekable || file_state_of(&lines->state, descriptor) ? CONUS_OK : fail_to_read();
}

void pose_lines_init_text(struct pose_lines *lines, struct text text)
{
    *lines = (struct pose_lines){.descriptor = -1, .data = text.data, .size = text.size, .ended = true};
}

void pose_lines_finish(struct pose_lines *lines)
{
    memory_free(lines->own);
    *lines = (struct pose_lines){.descriptor = -1};
}

/* Waits until a pipe has something, also one that was made not to wait. */
static ptrdiff_t read_some(const struct pose_lines *lines, char *at, size_t size, bool *stopped)
{
    for (;;) {
        *stopped = !lines->seekable && !system_wait(lines->descriptor, &lines->stop);
        ptrdiff_t got = *stopped          ? 0
                        : lines->seekable ? system_read_at(lines->descriptor, at, size, lines->offset)
                                          : read(lines->descriptor, at, size);
        if (got >= 0 || (errno != EINTR && errno != EAGAIN)) {
            return got;
        }
    }
}

/* Reads once. */
static conus_status read_more(struct pose_lines *lines)
{
    if (lines->data != lines->own && lines->size) {
        memmove(lines->own, lines->data, lines->size);
    }
    lines->data = lines->own;
    bool stopped = false;
    ptrdiff_t got = read_some(lines, lines->own + lines->size, CAPACITY - lines->size, &stopped);
    if (got < 0) {
        return fail_to_read();
    }
    struct file_state now; /* what is read after a change belongs to no one file */
    if (lines->seekable && !(file_state_of(&now, lines->descriptor) && file_state_equal(&now, &lines->state))) {
        return fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    sha256_update(&lines->hash, (size_t)got, (const uint8_t *)lines->own + lines->size);
    lines->size = stopped ? 0 : lines->size + (size_t)got; /* half a line is no row */
    lines->offset += (uint64_t)got;
    lines->ended = got == 0;
    return CONUS_OK;
}

conus_status pose_lines_fill(struct pose_lines *lines, size_t size)
{
    conus_status status = CONUS_OK;
    while (!status && !lines->ended && lines->size < size) {
        status = read_more(lines);
    }
    return status;
}

static void take_bytes(struct pose_lines *lines, size_t size)
{
    lines->data += size;
    lines->size -= size;
}

/* Bytes before the first LF or CR; lines->size if there is none. */
static size_t line_length(const struct pose_lines *lines)
{
    if (!lines->size) {
        return 0;
    }
    const char *end = memchr(lines->data, '\n', lines->size);
    size_t length = end ? (size_t)(end - lines->data) : lines->size;
    end = memchr(lines->data, '\r', length);
    return end ? (size_t)(end - lines->data) : length;
}

/* Takes the line's ending, if there is one. */
static void take_ending(struct pose_lines *lines)
{
    if (lines->size) {
        lines->after_cr = lines->data[0] == '\r';
        take_bytes(lines, 1);
    }
}

/* The second half of a CRLF, when the first ended the line before. */
static conus_status take_late_feed(struct pose_lines *lines)
{
    conus_status status = lines->after_cr ? pose_lines_fill(lines, 1) : CONUS_OK;
    if (!status && lines->after_cr && lines->size && lines->data[0] == '\n') {
        take_bytes(lines, 1);
    }
    lines->after_cr = false;
    return status;
}

static conus_status drop_long_line(struct pose_lines *lines)
{
    conus_status status = CONUS_OK;
    for (size_t length = line_length(lines); !status && length == lines->size; length = line_length(lines)) {
        take_bytes(lines, length);
        if (lines->ended) {
            return CONUS_OK;
        }
        status = read_more(lines);
    }
    if (!status) {
        take_bytes(lines, line_length(lines));
        take_ending(lines);
    }
    return status;
}

conus_status pose_lines_next(struct pose_lines *lines, struct pose_line *line, bool *found)
{
    conus_status status = take_late_feed(lines);
    size_t length = line_length(lines);
    while (!status && length == lines->size && length <= POSE_LINE_LIMIT && !lines->ended) {
        status = read_more(lines);
        length = line_length(lines);
    }
    if (status) {
        return status;
    }
    *found = lines->size > 0;
    if (!*found) {
        return CONUS_OK;
    }
    bool too_long = length > POSE_LINE_LIMIT;
    struct text text = {lines->data, too_long ? POSE_LINE_LIMIT : length};
    struct text trimmed = text_trim(text);
    bool is_comment = trimmed.size && trimmed.data[0] == '#';
    bool is_empty = text_has_only(trimmed, ",;\t "); /* as spreadsheets write an empty row */
    *line = (struct pose_line){.number = ++lines->number, .too_long = too_long, .blank = is_empty || is_comment};
    if (too_long) {
        line->blank = is_comment; /* what else may come is not known */
        line->text = (struct text){"", 0};
        return drop_long_line(lines);
    }
    line->text = text;
    take_bytes(lines, length);
    take_ending(lines);
    return CONUS_OK;
}

conus_status pose_lines_rest(struct bytes *out, struct pose_lines *lines, uint64_t limit)
{
    struct bytes bytes = {0};
    conus_status status = CONUS_OK;
    for (size_t capacity = 0; !status && (lines->size || !lines->ended);) {
        if (bytes.size + lines->size > limit) {
            status =
                fail(CONUS_ERROR_MEMORY, "more than %llu bytes, allowed of a format that is read whole (--max-memory)",
                     (unsigned long long)limit);
        }
        if (!status && bytes.size + lines->size > capacity) {
            capacity = 2 * (bytes.size + lines->size);
            uint8_t *data = memory_resize(bytes.data, capacity, 1);
            bytes.data = data ? data : bytes.data;
            status = data ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
        if (!status && lines->size) {
            memcpy(bytes.data + bytes.size, lines->data, lines->size);
            bytes.size += lines->size;
            take_bytes(lines, lines->size);
        }
        status = status || lines->ended ? status : read_more(lines);
    }
    if (status) {
        bytes_finish(&bytes);
        return status;
    }
    *out = bytes;
    return CONUS_OK;
}

conus_status pose_lines_sha256(char out[65], struct pose_lines *lines)
{
    conus_status status = CONUS_OK;
    while (!status && !lines->ended) {
        take_bytes(lines, lines->size);
        status = read_more(lines);
    }
    if (!status) {
        struct sha256_ctx hash = lines->hash;
        file_sha256_end(out, &hash);
    }
    return status;
}
