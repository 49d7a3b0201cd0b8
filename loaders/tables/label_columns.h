/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables with a header row: tabs or commas between the columns. */
#ifndef CONUS_LOADERS_TABLES_LABEL_COLUMNS_H
#define CONUS_LOADERS_TABLES_LABEL_COLUMNS_H

#include "loaders/tables/label_format.h"

/** The format of @p text, lines below a header row, by its content; NULL if it is none. */
const struct label_format *label_format_of_columns(struct text text);

#endif
