/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables of text that fit a terminal, and what a terminal can show. */
#ifndef CONUS_OPTIONS_TABLE_FIT_H
#define CONUS_OPTIONS_TABLE_FIT_H

#include <stdbool.h>
#include <stddef.h>

/** Fits the tables in @p text, UTF-8 with a final NUL, into @p width columns (0 = as wide as they are), and with
 * @p bold writes their headers so. Lines between them stay as they are. Where columns are left out, a last line names
 * those of the first such table, and says @p whole: "--format tsv has all". A table is lines with two gaps of two
 * spaces or more in their first, the header; its columns end where the words of the header end. NULL without memory;
 * the caller frees it. */
char *table_fit(const char *text, size_t width, bool bold, const char *whole);

/** Columns of the terminal at @p descriptor: as it says, else $COLUMNS; 0 where it is no terminal or nothing says. */
size_t terminal_width(int descriptor);

/** Whether @p descriptor is a terminal that shows bold and colours: neither $NO_COLOR nor TERM=dumb forbids them. */
bool terminal_has_colour(int descriptor);

#endif
