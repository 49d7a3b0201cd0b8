/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables that have an entry and its target in two rows of one name. */
#ifndef CONUS_POSES_ROWS_PAIRS_H
#define CONUS_POSES_ROWS_PAIRS_H

#include "poses/rows/columns.h"
#include "poses/rows/pose_list.h"

/** Adds the axes of a table with columns.pairs to @p list, in the order of their entries; each ends at its target.
 * CONUS_ERROR_DATA where a name has not one of each. */
conus_status pairs_parse(conus_pose_list *list, const struct columns *columns, struct text text,
                         const conus_pose_options *options);

#endif
