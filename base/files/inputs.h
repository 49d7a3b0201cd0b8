/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The files that this process has read, in that order (conus_inputs_keep()), so that none is replaced by an output. */
#ifndef CONUS_BASE_INPUTS_H
#define CONUS_BASE_INPUTS_H

#include "base/files/file.h"

struct system_stat;

/** A file is opened to be read; @p info is what stat() says of it, NULL = nothing. False where it is no input: it is no
 * regular file, or the thread searches. */
bool inputs_read(const char *path, const struct system_stat *info);

/** The same of a file that was read earlier, as it was then. */
void inputs_put(const char *path, const struct file_state *state);

/** While a thread searches, it reads files to find out whether they belong to what it makes. Those that do become
 * inputs by file_trace_take(). Gives what was, to be set again. */
bool inputs_search(bool searches);

/** The file @p path has been made by this process, which may read it and make it again. */
void inputs_product(const char *path);

#endif
