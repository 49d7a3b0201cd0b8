/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tab-separated lines as columns for people. */
#ifndef CONUS_CLI_ANSWERS_ALIGNED_H
#define CONUS_CLI_ANSWERS_ALIGNED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { ALIGNED_COLUMNS = 16 }; /**< At most. */

/** Has @p put write what it knows of @p what, a header and lines of @p columns cells with tabs between them, and sets
 * that out in columns; those without any value but "n/a" are left out. right[c]: column c ends in line. False without
 * memory. */
bool aligned_put(FILE *out, void put(FILE *out, const void *what), const void *what, size_t columns,
                 const bool right[]);
/** Writes a text of any bytes as one cell; "n/a" if there is none. */
void aligned_put_cell(FILE *out, const char *text);

#endif
