/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses from matrices that other programs write (include/conus has the rest of poses). */
#ifndef CONUS_POSES_ROWS_POSE_H
#define CONUS_POSES_ROWS_POSE_H

#include "conus/conus.h"

/** conus_pose_from_matrix() for a file that rounds more: deviations up to @p tolerance are made exact. */
conus_status pose_from_matrix_within(conus_pose *out, const double world_from_device[16], double tolerance);

#endif
