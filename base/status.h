/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How internal functions report failure, and what they note on the way. */
#ifndef CONUS_BASE_STATUS_H
#define CONUS_BASE_STATUS_H

#include "conus/status.h"

#include <stdint.h>

/* How internal functions report failure: a status, and one line kept per thread. The line is written where the fact
 * is known and only ever prefixed further up. */

/** Sets this thread's message from @p format (one line, no final period) and returns @p status. */
conus_status fail(conus_status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Puts "@p where: " in front of this thread's message and returns @p status, so that a reader of bytes
 * need not know its path: `return fail_in(status, path);` */
conus_status fail_in(conus_status status, const char *where);

#ifdef __clang_analyzer__ /* which does not see that they return their argument */
#define fail(status, ...) ((void)fail(status, __VA_ARGS__), (status))
#define fail_in(status, where) ((void)fail_in(status, where), (status))
#endif

/** How a function that makes a thing ends: *out gets it, or after a failure `end` frees what there is. Gives the
 * status, a variable, since it is read before and after `end`. */
#define GIVE(status, out, thing, end)                                                                                  \
    ((status) != CONUS_OK ? ((void)(end), (conus_status)(status)) : ((void)(*(out) = (thing)), (conus_status)CONUS_OK))

/* Notes gathered on the way, for the reader of the result, or passed to a log at once. */

/** The caller's log for notes, as they are made. */
struct note_sink {
    conus_log log; /**< NULL = none. */
    void *user;
    const char *path; /**< The file that is being read; NULL = none. */
};

struct note_mark {
    conus_severity severity;
    bool is_passed; /**< A sink has it. */
};

struct notes {
    char **lines;
    struct note_mark *marks; /**< [count] */
    size_t count;
    const struct note_sink *sink; /**< Receives what is added; NULL = notes wait for notes_move(). */
};

void notes_finish(struct notes *notes);

/** Adds one line and passes it to the sink. CONUS_ERROR_MEMORY if it cannot be kept: a lost warning is a failure. */
conus_status notes_put(struct notes *notes, conus_severity severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Adds what was chosen, assumed, left out, or is odd, while the answer names the places and areas that the data mean.
 */
#define notes_add(notes, ...) notes_put(notes, CONUS_SEVERITY_NOTE, __VA_ARGS__)

/** Adds that an answer may well name another place or another area than the data mean. */
#define notes_warn(notes, ...) notes_put(notes, CONUS_SEVERITY_WARNING, __VA_ARGS__)

/** How much note @p index matters; past the last CONUS_SEVERITY_NOTE. */
conus_severity notes_severity(const struct notes *notes, size_t index);

/** Passes to the sink what no other has received: what was added while there was none. */
void notes_tell(struct notes *notes);

/** Forgets all lines but the first @p count. */
void notes_cut(struct notes *notes, size_t count);

/** Appends the lines of @p from, which is left empty and keeps its sink. The sink receives those that no other has
 * received. */
conus_status notes_move(struct notes *notes, struct notes *from);

/** The same, each line with "@p where: " in front. */
conus_status notes_move_in(struct notes *notes, struct notes *from, const char *where);

#endif
