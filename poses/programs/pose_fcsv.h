/* SPDX-License-Identifier: BSD-3-Clause */
/** @file 3D Slicer's lists of fiducials, .fcsv. */
#ifndef CONUS_POSES_PROGRAMS_POSE_FCSV_H
#define CONUS_POSES_PROGRAMS_POSE_FCSV_H

#include "poses/rows/pose_list.h"

/** Whether a line stands at the head of such a list and of no other file. */
bool pose_fcsv_line(struct text line);

/** Points, named by their labels; of Slicer 3 (label,x,y,z,sel,vis) and since 4 (id,x,y,z, …, label, …). */
conus_status pose_fcsv_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

#endif
