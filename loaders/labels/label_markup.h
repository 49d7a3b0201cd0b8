/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables in XML. */
#ifndef CONUS_LOADERS_TABLES_LABEL_MARKUP_H
#define CONUS_LOADERS_TABLES_LABEL_MARKUP_H

#include "loaders/labels/label_format.h"
#include "loaders/labels/label_use.h"

/** The format of @p text, which begins with "<", by its content; NULL if it is none. */
const struct label_format *label_format_of_markup(struct text text);

extern const struct label_format label_format_workbench;
extern const struct label_format label_format_fsl;
extern const struct label_format label_format_spm; /**< SPM's and CAT12's atlas XML. */

/** Workbench's table of volume @p volume of a 4-D file; label_format_workbench takes the first. */
conus_status label_workbench_parse(struct label_table *out, struct text text, size_t volume, struct notes *notes);

/** An atlas XML's of FSL or SPM, numbered as for @p use (fsl_atlas.h); label_format_fsl goes by its type. */
conus_status label_fsl_parse(struct label_table *out, struct text text, const struct label_use *use,
                             struct notes *notes);

#endif
