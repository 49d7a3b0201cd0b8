/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The files that this process has read, in that order (conus_inputs_keep()), so that none is replaced by an output. */
#ifndef CONUS_BASE_INPUTS_H
#define CONUS_BASE_INPUTS_H

#include <stdbool.h>

struct system_stat;

/** The file @p path is opened to be read; @p info is what stat() says of it, NULL = nothing. It becomes an input where
 * it is a regular file, unless the thread searches. */
void inputs_read(const char *path, const struct system_stat *info);

/** While a thread searches, it reads files to find out whether they belong to what it makes. Those that do become
 * inputs by inputs_take(). Gives what was, to be set again. */
bool inputs_search(bool searches);

/** The file @p path was read while the thread searches, and belongs to what it makes. Does nothing at other times. */
void inputs_take(const char *path);

/** The file @p path has been made by this process, which may read it and make it again. */
void inputs_product(const char *path);

#endif
