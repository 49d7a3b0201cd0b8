/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tab-separated lines as columns for people. */
#ifndef CONUS_CLI_ANSWERS_ALIGNED_H
#define CONUS_CLI_ANSWERS_ALIGNED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { ALIGNED_COLUMNS = 16 }; /**< At most. */

/** Sets out @p tsv, a header and lines of @p columns cells each, in columns; those without any value but "n/a" are left
 * out. right[c]: column c ends in line. */
void aligned_put(FILE *out, const char *tsv, size_t columns, const bool right[]);

#endif
