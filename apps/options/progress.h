/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Long pieces of work: the clock, how far they have got, and signals that end them. */
#ifndef CONUS_OPTIONS_PROGRESS_H
#define CONUS_OPTIONS_PROGRESS_H

#include "conus/pose.h"

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

/* The one clock of the programs. */

/** Monotonic time in ms, from an arbitrary origin. */
static inline double clock_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* How far a long piece of work has got, on stderr: on a terminal at most ten times a second, on one line that is
 * gone at the end; in a file or pipe a line every five minutes. */

enum progress_kind { PROGRESS_AUTO, PROGRESS_JSON, PROGRESS_NONE };

extern const char *const progress_kinds[]; /**< Their names; ends with NULL. */

struct progress {
    enum progress_kind kind;
    const char *what; /**< "poses" */
    bool on_terminal;
    bool in_log;           /**< A line now and then. */
    uint64_t total;        /**< 0 = not known. */
    uint64_t before;       /**< Done when it began. */
    const char *more;      /**< Ends the lines for people; NULL = nothing. */
    double started, shown; /**< By clock_ms(). */
};

/** @p quiet: no lines for people. @p what is counted: "poses"; @p total of them, 0 = not known. */
void progress_start(struct progress *out, enum progress_kind kind, bool quiet, const char *what, uint64_t total);

/** Whether progress will be shown, so that it is worth counting the work. */
bool progress_is_shown(const struct progress *progress);

void progress_update(struct progress *progress, uint64_t done, uint64_t errors);

/** The last word; clears a terminal's line. */
void progress_finish(struct progress *progress, uint64_t done, uint64_t errors);

/* SIGINT and SIGTERM, kept until a long piece of work comes to a place where it can end. */

/** From here on the first of each is kept, and stops @p poses, so that nothing waits for a silent pipe; the second one
 * ends the program. One that is ignored stays so. */
void interrupt_catch(conus_pose_stream *poses);

/** The poses are left alone from here on: to be called before they are destroyed. */
void interrupt_release(void);

/** The signal that was caught last; 0 if there was none. */
int interrupt_signal(void);

#endif
