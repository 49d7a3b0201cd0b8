/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which areas streamlines connect, from inside (Eq. 20). */
#ifndef CONUS_SELECTION_ENDS_CONNECTIVITY_H
#define CONUS_SELECTION_ENDS_CONNECTIVITY_H

#include "conus/study.h"
#include "selection/table/table.h"

/* Columns of its table. */
extern const struct table_fields connection_fields;

/** Lists the areas of the matrix as rows of a table: *out is freed by the caller. CONUS_ERROR_MEMORY. */
conus_status connection_areas_list(struct table_object **out, size_t *count, const conus_selector *selector);

#endif
