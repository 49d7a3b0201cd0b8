/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A program that runs as a child, with limits: the process, and what is asked of it. */
#ifndef CONUS_BASE_CHILD_CHILD_H
#define CONUS_BASE_CHILD_CHILD_H

#include "base/files/file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

/** Waits for the end, as process_read() does; false = late. */
bool process_wait(struct process_end *out, struct process *process, double seconds);
/** Ends it where it still runs. */
void process_finish(struct process *process);

/* Runs a program that links a large library, with limits on memory, processor time and waiting. If the library
 * crashes or never ends, that costs an error line and nothing else. The program has an empty stdin, its input as
 * descriptor 3 and no other descriptors, and ends when its parent does (on macOS, which cannot be told so, when it
 * next writes). On Linux it cannot write to files and gains no rights; Windows and macOS have less of that
 * (struct process). */

struct child_program {
    const char *name;     /**< "conus-mesh"; also that of its Debian package.     */
    const char *variable; /**< The environment's variable that names another one. */
    const char *library;  /**< The one that may crash: "VTK". */
};

struct child_limits {
    uint64_t memory;  /**< Bytes: address space of the program, and what may wait here to be taken. */
    uint64_t beside;  /**< Bytes that the program may map beside that.                              */
    uint32_t seconds; /**< Processor time of all its threads. */
    uint32_t wait;    /**< Seconds until it must have ended; a busy machine gives it a small part. */
};

/** Gets what came and was not used yet, @p size bytes: *used of them are done with, and the next step takes *wanted,
 * counted from there. */
typedef conus_status (*child_take)(void *user, size_t *used, size_t *wanted, const uint8_t *data, size_t size);

/** A run of a program. */
struct child_task {
    const struct child_program *program;
    struct child_limits limits;
    char *const *words; /**< As of execv(): the first is the program's name. */
    int descriptor;     /**< Descriptor of the input; the caller's to close. */
    child_take take;    /**< NULL = all that comes is kept.        */
    void *user;
};

/** The path of a program: $variable, else beside the running program, else in $PATH. CONUS_ERROR_UNSUPPORTED where
 * there is none. memory_free() it. */
conus_status child_find(char **path, const struct child_program *program);

/** Runs the program to its end. @p rest gets the output that `take` did not use; the caller's to finish. Fails with the
 * status of `take`, or with one line about how the program failed: a crash, too much memory or time, its message on
 * stderr. Whatever it returns, no process is left. */
conus_status child_run(struct bytes *rest, const struct child_task *task);

#endif
