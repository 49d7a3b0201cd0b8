/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables for people on a terminal: columns that do not fit are left out, the last ones first. */
#ifndef CONUS_COMMON_TABLE_FIT_H
#define CONUS_COMMON_TABLE_FIT_H

#include <stdbool.h>
#include <stddef.h>

/** Fits the tables in @p text, UTF-8 with a final NUL, into @p width columns (0 = as wide as they are), and with
 * @p bold writes their headers so. Lines between them stay as they are. Where columns are left out, a last line names
 * those of the first such table, and says @p whole: "--format tsv has all". A table is lines with two gaps of two
 * spaces or more in their first, the header; its columns end where the words of the header end. NULL without memory;
 * the caller frees it. */
char *table_fit(const char *text, size_t width, bool bold, const char *whole);

#endif
