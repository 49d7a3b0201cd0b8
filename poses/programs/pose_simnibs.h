/* SPDX-License-Identifier: BSD-3-Clause */
/** @file SimNIBS's coil positions. */
#ifndef CONUS_POSES_PROGRAMS_POSE_SIMNIBS_H
#define CONUS_POSES_PROGRAMS_POSE_SIMNIBS_H

#include "poses/rows/pose_list.h"

/** SimNIBS's matsimnibs: in a MAT-file of a SESSION, a TMSLIST or a POSITION, or as a text of 16 numbers each. @p text
 * is no longer than pose_memory(). */
conus_status pose_simnibs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

#endif
