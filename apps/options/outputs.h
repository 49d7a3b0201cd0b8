/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The files that a command line writes, and whether they may be: no file replaces another one unless --force is given.
 */
#ifndef CONUS_OPTIONS_OUTPUTS_H
#define CONUS_OPTIONS_OUTPUTS_H

#include "options/options.h"

#include <stdbool.h>
#include <stddef.h>

/** A file that is written. */
struct output {
    char what[64]; /**< "--output" or "the .json beside --output", for messages. */
    const char *path;
    bool is_sidecar; /**< It is beside another one. */
};

enum { OUTPUT_LIMIT = 16 };

struct outputs {
    struct output items[OUTPUT_LIMIT];
    size_t count;
};

/** Whether the value of --sidecar says that there is none. */
bool sidecar_is_none(const char *given);

/** Lists the files that options of the command line name: the answer, the sidecar, those that belong to it, and rows.
 * Their paths are the command line's. */
void outputs_collect(struct outputs *out, const struct arguments *arguments);
/** Has the process keep the list of all that it reads, and adds the files that the command line names. Returns the exit
 * code and prints an error unless it is 0. */
int outputs_begin(const struct arguments *arguments);
/** Adds the sidecar beside the file of @p option; no path (NULL) is fine. */
void outputs_add_sidecar(struct outputs *out, const char *option, const char *path);

/** Whether all are different files; prints an error if not. */
bool outputs_differ(const struct outputs *outputs);

/** Whether none would take the place of a file that the command line names as an input, or that was read by now, also
 * by a link to it (conus_inputs_find()); prints an error if one would. */
bool outputs_spare_inputs(const struct outputs *outputs);
/** The same of one file that @p what names, "--output". */
bool output_spares_inputs(const char *what, const char *path);

/** Whether they can be written: their folders are there, and no file is where one goes; with @p force only a sidecar
 * may be where a sidecar goes, and @p force without a file is an error. Devices, pipes and what is open already
 * (/dev/stdout) are written to, not replaced. Returns the exit code and prints an error unless it is 0. */
int outputs_check(const struct outputs *outputs, bool force);

/** Whether a sidecar may be written to @p path, with --force: nothing is there, or a sidecar. Likewise. */
int outputs_check_sidecar(const char *path);

/** Whether a sidecar can hold a path or a word of the command line: what has control characters, or bytes that are no
 * UTF-8, could not be found again. Likewise. */
int outputs_check_name(const char *name);

#endif
