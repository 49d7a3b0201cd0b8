/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lines of a text of any length, one at a time, from a file, a pipe or memory, in memory that does not grow. */
#ifndef CONUS_POSES_ROWS_POSE_LINES_H
#define CONUS_POSES_ROWS_POSE_LINES_H

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/system/system.h"
#include "base/text.h"

#include <nettle/sha2.h>

enum { POSE_LINE_LIMIT = 65535 }; /**< Longest line that is read, in bytes, without its ending. */

/** Where lines come from. All 0 but `descriptor` = -1 is an empty text. What is stopped ends behind its last whole
 * line. */
struct pose_lines {
    int descriptor;          /**< Borrowed; -1: all there is lies in `data`.                        */
    bool seekable;           /**< A regular file: read at `offset`, without moving the descriptor.  */
    struct system_wake stop; /**< Not seekable: once woken, there is nothing more; borrowed. */
    uint64_t offset;         /**< Where in it the bytes after those in `data` are.                  */
    const char *data;        /**< Bytes not yet taken; in `own`, or borrowed.                       */
    size_t size;
    char *own; /**< NULL where `data` is borrowed. */
    bool ended;
    bool after_cr; /**< A LF that comes now belongs to the line before. */
    size_t number; /**< Lines taken. */

    struct file_state state; /**< Seekable: of the file when it was opened, */
    struct sha256_ctx hash;  /**< and of the bytes that were read. */
};

struct pose_line {
    struct text text; /**< "" when too long. */
    size_t number;    /**< From 1. */
    bool too_long;
    bool blank; /**< Too long, and a comment: no data. */
};

/** Lines of an open file, from @p offset where it is seekable: then CONUS_ERROR_IO once it changes.
 * pose_lines_finish() ends it, without closing. */
conus_status pose_lines_init(struct pose_lines *lines, int descriptor, bool seekable, uint64_t offset);
/** Lines of a text that outlives them. */
void pose_lines_init_text(struct pose_lines *lines, struct text text);
void pose_lines_finish(struct pose_lines *lines);

/** Begins the text, after pose_lines_init(): takes off a byte order mark. UTF-16, which it tells, is read as a whole
 * and becomes UTF-8; CONUS_ERROR_MEMORY above @p limit bytes. */
conus_status pose_lines_begin(struct pose_lines *lines, uint64_t limit);

/** Reads on until @p size bytes (at most POSE_LINE_LIMIT) lie in `data`, or all there are, or, where that is enough,
 * until a pipe is silent for a fifth of a second and something is there. */
conus_status pose_lines_fill(struct pose_lines *lines, size_t size, bool may_be_silent);

/** Takes the next line, ended by LF, CR, CRLF or the end; *found = false when there is none. The line's text lives
 * until the next call. */
conus_status pose_lines_next(struct pose_lines *lines, struct pose_line *line, bool *found);

/** Appends all that is left, CONUS_ERROR_MEMORY above @p limit bytes. @p out is the caller's to finish. */
conus_status pose_lines_rest(struct buffer *out, struct pose_lines *lines, uint64_t limit);

/** SHA-256 of all that was read, and of what is left, which is taken, too. Seekable only. */
conus_status pose_lines_sha256(char out[65], struct pose_lines *lines);

#endif
