/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A process that runs a program, with limits. Programs have it beside the library. */
#ifndef CONUS_BASE_CHILD_PROCESS_H
#define CONUS_BASE_CHILD_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

/* A process that runs a program: what systems do differently about it. What fails has errno set. */

/** What the file of a program ends in. */
#ifdef _WIN32
#define PROCESS_FILE_ENDING ".exe"
#else
#define PROCESS_FILE_ENDING ""
#endif

/** What a process may take. */
struct process_limits {
    uint64_t space;   /**< Bytes that it may map; UINT64_MAX = any number. */
    uint32_t seconds; /**< Processor time of all its threads. */
};

/** How a program is started: with an empty stdin, and no descriptors but stdout, stderr and one more. */
struct process_start {
    const char *path;                    /**< Of the program. */
    char *const *words;                  /**< As of execv(): the first is the program's name. */
    int given;                           /**< What becomes its descriptor 3; SYSTEM_NO_FILE = nothing. */
    const struct process_limits *limits; /**< On Linux it gains no rights, too, and writes to no file, on macOS it
                                              writes to none, on Windows it starts no program. */
};

/** A process. To be process_finish()ed wherever process_begin() succeeded. */
struct process {
    intptr_t id;      /**< 0 = it has ended. */
    intptr_t ends[2]; /**< What its stdout and stderr are read from; -1 = they have ended. */
    void *state;      /**< Of the system. */
};

enum { PROCESS_OUT, PROCESS_ERR };

/** Starts it; false where the program cannot be run. On Linux and Windows it does not outlive this process. */
bool process_begin(struct process *out, const struct process_start *start);

/** Room for what was written, and how much came. */
struct process_part {
    void *data;
    size_t capacity, got;
};

enum process_reading { PROCESS_CAME, PROCESS_LATE, PROCESS_FAILED };

/** Whether more may come from its stdout or stderr. */
bool process_writes(const struct process *process);
/** Waits for more of stdout or stderr, or the end of one, at most so many seconds; INFINITY = as long as it takes. */
enum process_reading process_read(struct process_part parts[2], struct process *process, double seconds);

/** How a process ended. */
struct process_end {
    enum { PROCESS_EXITED, PROCESS_CRASHED, PROCESS_NO_MEMORY, PROCESS_NO_TIME } kind;
    int code;     /**< Of its exit. */
    char how[96]; /**< Of a crash: "signal 11, Segmentation fault". */
};

/** Seconds of a clock that setting the date does not move, for deadlines. */
static inline double process_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/** Waits for the end, as process_read() does; false = late. */
bool process_wait(struct process_end *out, struct process *process, double seconds);
/** Ends it where it still runs. */
void process_finish(struct process *process);

#endif
