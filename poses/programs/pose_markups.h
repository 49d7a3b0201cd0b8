/* SPDX-License-Identifier: BSD-3-Clause */
/** @file 3D Slicer's markups. */
#ifndef CONUS_POSES_PROGRAMS_POSE_MARKUPS_H
#define CONUS_POSES_PROGRAMS_POSE_MARKUPS_H

#include "poses/rows/pose_list.h"

/** 3D Slicer's markups: .mrk.json, lines and points, or .fcsv, points. */
conus_status pose_markups_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

#endif
