/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of poses, a table. */
#ifndef CONUS_POSES_POSE_FORMATS_H
#define CONUS_POSES_POSE_FORMATS_H

#include "poses/rows/pose_list.h"

/** A parser of a text as a whole. It adds the rows of the text, with notes and the space that it names, to the list; a
 * bad pose is a row with its error. */
typedef conus_status (*pose_parser)(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** NULL of a format that is read line by line. */
pose_parser pose_format_parser(conus_pose_format format);

#endif
