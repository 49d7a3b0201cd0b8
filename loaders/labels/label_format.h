/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a format of label tables is: its name and its parser. */
#ifndef CONUS_LOADERS_TABLES_LABEL_FORMAT_H
#define CONUS_LOADERS_TABLES_LABEL_FORMAT_H

#include "atlas/labels/labels.h"

/** A format of label tables. */
struct label_format {
    const char *name; /**< In words, for messages and "where the names come from". */
    /** Appends the table in @p text to @p out, in any order; label 0 is dropped. */
    conus_status (*parse)(struct label_table *out, struct text text, struct notes *notes);
};

#endif
