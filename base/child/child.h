/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A program that runs as a child, with limits, and what is asked of it. */
#ifndef CONUS_BASE_CHILD_CHILD_H
#define CONUS_BASE_CHILD_CHILD_H

#include "base/child/process.h"
#include "base/files/file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
