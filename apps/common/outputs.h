/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The one rule about files that a command writes: none replaces what is there, unless --force is given. */
#ifndef CONUS_COMMON_OUTPUTS_H
#define CONUS_COMMON_OUTPUTS_H

#include <stdbool.h>
#include <stddef.h>

/** A file that is written. */
struct output {
    const char *what; /**< "--output", for messages. */
    const char *path; /**< NULL = none, or standard output. */
    bool is_sidecar;  /**< It is beside another one. */
};

/** Whether all are different files; prints an error if not. */
bool outputs_differ(const struct output *outputs, size_t count);

/** Whether they can be written: their folders are there, and no file is where one goes; with @p force only a sidecar
 * may be where a sidecar goes, and @p force without a file is an error. Devices, pipes and what is open already
 * (/dev/stdout) are written to, not replaced. Returns the exit code and prints an error unless it is 0. */
int outputs_check(const struct output *outputs, size_t count, bool force);

/** Whether a sidecar may be written to @p path, with --force: nothing is there, or a sidecar. Likewise. */
int outputs_check_sidecar(const char *path);

/** Whether a sidecar can hold a path or a word of the command line: what has control characters, or bytes that are no
 * UTF-8, could not be found again. Likewise. */
int outputs_check_name(const char *name);

#endif
