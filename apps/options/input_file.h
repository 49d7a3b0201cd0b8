/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reading files that somebody names, of any kind and size, without waiting or growing for ever. */
#ifndef CONUS_OPTIONS_INPUT_FILE_H
#define CONUS_OPTIONS_INPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/** Opens a regular file; NULL, after an error message, for all else. */
FILE *input_file_open(const char *path);

enum input_kind { INPUT_FILE, INPUT_FILE_OR_PIPE };

/** Reads @p path, at most @p limit bytes; a NUL stands behind them. @p text is the caller's to free(). Returns the exit
 * code and prints an error unless it is 0. */
int input_file_read(char **text, size_t *size, const char *path, enum input_kind kind, uint64_t limit);

/** Whether a file of poses, with the words behind it, is standard input; and whether it is that or a pipe, and so can
 * be read but once. */
bool poses_are_stdin(const char *path);
bool poses_are_no_file(const char *path);

#endif
