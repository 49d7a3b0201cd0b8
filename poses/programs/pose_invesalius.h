/* SPDX-License-Identifier: BSD-3-Clause */
/** @file InVesalius's markers. */
#ifndef CONUS_POSES_PROGRAMS_POSE_INVESALIUS_H
#define CONUS_POSES_PROGRAMS_POSE_INVESALIUS_H

#include "poses/rows/pose_list.h"

/** InVesalius's markers, .mkss, by their world columns: poses of the coil, and points. */
conus_status pose_invesalius_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether @p line is the first one of such a file. */
bool pose_invesalius_line(struct text line);

#endif
