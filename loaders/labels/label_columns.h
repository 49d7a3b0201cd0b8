/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables with a header row: tabs or commas between the columns. */
#ifndef CONUS_LOADERS_TABLES_LABEL_COLUMNS_H
#define CONUS_LOADERS_TABLES_LABEL_COLUMNS_H

#include "loaders/labels/label_format.h"

/** The format of @p text, lines below a header row, by its content; NULL if it is none. */
const struct label_format *label_format_of_columns(struct text text);

/** Appends the table in @p text to @p out, whose header row calls number and name @p columns; an empty one is found by
 * the usual words. CONUS_ERROR_DATA where there is no such column. */
conus_status label_columns_parse(struct label_table *out, struct text text, const struct text columns[2],
                                 struct notes *notes);

/** Fails with the columns that the first row of @p text has and those that are needed; CONUS_OK where it has no two.
 */
conus_status label_columns_refuse(struct text text);

#endif
