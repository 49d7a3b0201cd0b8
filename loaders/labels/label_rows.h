/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables with white space between the columns and no header row. */
#ifndef CONUS_LOADERS_TABLES_LABEL_ROWS_H
#define CONUS_LOADERS_TABLES_LABEL_ROWS_H

#include "loaders/labels/label_format.h"

/** FSLeyes's colours without names: it names nothing. */
extern const struct label_format label_format_colours;

/** The format of @p text, lines of columns, by its content; NULL if it is none. */
const struct label_format *label_format_of_rows(struct text text);

#endif
