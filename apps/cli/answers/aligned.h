/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tab-separated lines as columns for people. */
#ifndef CONUS_CLI_ANSWERS_ALIGNED_H
#define CONUS_CLI_ANSWERS_ALIGNED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { ALIGNED_COLUMNS = 16 }; /**< At most. */

/** Calls @p put, which writes a header and lines of @p columns cells with tabs between them, and sets these out in
 * columns. Columns whose only value is "n/a" are left out. right[c]: column c is aligned to the right. False without
 * memory. */
bool aligned_put(FILE *out, void put(FILE *out, const void *what), const void *what, size_t columns,
                 const bool right[]);
/** Writes a text of any bytes as one cell; "n/a" if there is none. */
void aligned_put_cell(FILE *out, const char *text);

#endif
