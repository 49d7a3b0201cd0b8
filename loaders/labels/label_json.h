/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables in JSON. */
#ifndef CONUS_LOADERS_TABLES_LABEL_JSON_H
#define CONUS_LOADERS_TABLES_LABEL_JSON_H

#include "loaders/labels/label_format.h"

/** The format of @p text, which begins with a brace or bracket, by its content; NULL if it is none. */
const struct label_format *label_format_of_json(struct text text);

#endif
