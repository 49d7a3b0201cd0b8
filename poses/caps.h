/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a cap of electrodes, which names no space, lies on the head of MNI 152. */
#ifndef CONUS_POSES_CAPS_H
#define CONUS_POSES_CAPS_H

#include "poses/rows/pose_list.h"

/** Checks the rows of a cap, brings them to mm by list->space.scale (0 = the cap names no unit), and sets list->space:
 * CONUS_ERROR_DATA, with what fits better, unless the names that are positions (positions.h) lie where MNI 152 has
 * them. */
conus_status cap_check(conus_pose_list *list);

#endif
