/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses from text: a table whose header names the columns, or one plain 4 x 4 matrix. */
#ifndef CONUS_SELECTION_POSE_LIST_H
#define CONUS_SELECTION_POSE_LIST_H

#include "base/text.h"
#include "conus/conus.h"

struct conus_pose_list {
    conus_pose_row *rows; /**< Strings are owned. */
    size_t count;
    size_t capacity;
};

/** Parses @p text (docs/formats.md). A row that is no pose is kept with its error; CONUS_ERROR_DATA is for a text in
 * which no row can be read: an unknown or missing column, no rows, not text. */
conus_status pose_list_parse(conus_pose_list **out, struct text text, conus_space space);

#endif
