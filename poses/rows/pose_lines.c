/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads lines in blocks of fixed size. */
#include "poses/rows/columns.h"

#include "base/memory.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <string.h>

enum { CAPACITY = 4 * (POSE_LINE_LIMIT + 1), SILENCE_MS = 200 };

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
                                 .stop.file = SYSTEM_NO_FILE,
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

/* Waits until a pipe has something, also one that was made not to wait; up to most_ms, -1 = without end. */
static ptrdiff_t read_some(const struct pose_lines *lines, char *at, size_t size, bool *stopped, int most_ms,
                           bool *silent)
{
    for (;;) {
        *silent = false;
        *stopped = !lines->seekable && !system_wait(lines->descriptor, &lines->stop, most_ms, silent);
        ptrdiff_t got = *stopped || *silent ? 0
                        : lines->seekable   ? system_read_at(lines->descriptor, at, size, lines->offset)
                                            : system_read(lines->descriptor, at, size);
        if (got >= 0 || (errno != EINTR && errno != EAGAIN)) {
            return got;
        }
    }
}

/* Reads once. A pipe that stays silent gives nothing. */
static conus_status read_within(struct pose_lines *lines, int most_ms, bool *silent)
{
    if (lines->data != lines->own && lines->size) {
        memmove(lines->own, lines->data, lines->size);
    }
    lines->data = lines->own;
    bool stopped = false;
    char *at = lines->own + lines->size;
    ptrdiff_t got = read_some(lines, at, CAPACITY - lines->size, &stopped, most_ms, silent);
    if (got < 0) {
        return fail_to_read();
    }
    if (*silent) {
        return CONUS_OK;
    }
    struct file_state now; /* what is read after a change belongs to no one file */
    if (lines->seekable && !(file_state_of(&now, lines->descriptor) && file_state_equal(&now, &lines->state))) {
        return fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    sha256_update(&lines->hash, (size_t)got, (const uint8_t *)at);
    lines->size = stopped ? 0 : lines->size + (size_t)got; /* half a line is no row */
    lines->offset += (uint64_t)got;
    lines->ended = got == 0;
    return CONUS_OK;
}

static void take_bytes(struct pose_lines *lines, size_t size)
{
    lines->data += size;
    lines->size -= size;
}

conus_status pose_lines_fill(struct pose_lines *lines, size_t size, bool may_be_silent)
{
    conus_status status = CONUS_OK;
    bool silent = false;
    while (!status && !lines->ended && lines->size < size && !silent) {
        status = read_within(lines, may_be_silent && lines->size ? SILENCE_MS : -1, &silent);
    }
    return status;
}

/* All of it becomes UTF-8. */
static conus_status narrow_all(struct pose_lines *lines, bool is_big, uint64_t limit)
{
    struct buffer wide = {0};
    conus_status status = pose_lines_rest(&wide, lines, limit);
    char *own = status ? NULL : memory_raw(2 * wide.size + 8, 1);
    if (own) {
        lines->size = text_from_utf16(own, 2 * wide.size + 8, (struct text){wide.data, wide.size}, is_big);
        memory_free(lines->own);
        lines->own = own;
        lines->data = own;
    }
    buffer_finish(&wide);
    return status || own ? status : CONUS_ERROR_MEMORY;
}

conus_status pose_lines_begin(struct pose_lines *lines, uint64_t limit)
{
    static const struct text marks[] = {{"\xef\xbb\xbf", 3}, {"\xff\xfe", 2}, {"\xfe\xff", 2}};
    conus_status status = pose_lines_fill(lines, 3, false);
    for (size_t i = 0; !status && i < sizeof marks / sizeof marks[0]; i++) {
        if (lines->size >= marks[i].size && memcmp(lines->data, marks[i].data, marks[i].size) == 0) {
            take_bytes(lines, marks[i].size);
            return i ? narrow_all(lines, i == 2, limit) : CONUS_OK;
        }
    }
    return status;
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
    conus_status status = lines->after_cr ? pose_lines_fill(lines, 1, false) : CONUS_OK;
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
        status = pose_lines_fill(lines, lines->size + 1, false);
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
        status = pose_lines_fill(lines, lines->size + 1, false);
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
    *line = (struct pose_line){.number = ++lines->number, .too_long = too_long, .text = text};
    if (too_long) {
        line->blank = text_starts(text_trim(text), "#"); /* what else may come is not known */
        line->text = text_from("");
        return drop_long_line(lines);
    }
    take_bytes(lines, length);
    take_ending(lines);
    return CONUS_OK;
}

conus_status pose_lines_rest(struct buffer *out, struct pose_lines *lines, uint64_t limit)
{
    conus_status status = CONUS_OK;
    while (!status && (lines->size || !lines->ended)) {
        if (out->size + lines->size > limit) {
            return fail(CONUS_ERROR_MEMORY,
                        "more than %llu bytes, allowed of a format that is read whole (--max-memory)",
                        (unsigned long long)limit);
        }
        buffer_append(out, lines->data, lines->size);
        take_bytes(lines, lines->size);
        status = buffer_status(out);
        status = status || lines->ended ? status : pose_lines_fill(lines, lines->size + 1, false);
    }
    return status;
}

conus_status pose_lines_sha256(char out[65], struct pose_lines *lines)
{
    conus_status status = CONUS_OK;
    while (!status && !lines->ended) {
        take_bytes(lines, lines->size);
        status = pose_lines_fill(lines, lines->size + 1, false);
    }
    if (!status) {
        struct sha256_ctx hash = lines->hash;
        file_sha256_end(out, &hash);
    }
    return status;
}
