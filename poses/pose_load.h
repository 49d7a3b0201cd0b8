/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All poses of a text at once. */
#ifndef CONUS_POSES_POSE_LOAD_H
#define CONUS_POSES_POSE_LOAD_H

#include "poses/rows/pose_list.h"

/** Parses @p text (docs/formats.md). A row that is no pose is kept with its error; CONUS_ERROR_DATA is for a text in
 * which no row can be read: an unknown or missing column, nothing at all, not text. @p options NULL = the default. */
conus_status pose_list_parse(conus_pose_list **out, struct text text, const conus_pose_options *options);

#endif
