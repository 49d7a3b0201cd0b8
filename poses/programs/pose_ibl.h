/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The International Brain Laboratory's positions of probes. */
#ifndef CONUS_POSES_PROGRAMS_POSE_IBL_H
#define CONUS_POSES_PROGRAMS_POSE_IBL_H

#include "poses/rows/pose_list.h"

/** Whether @p text is JSON that says so: it has the key xyz_picks or channel_0. CONUS_ERROR_MEMORY where that cannot be
 * found out. */
conus_status pose_ibl_is(bool *out, struct text text);

/** The points of xyz_picks.json, or the channels of channel_locations.json: micrometres ML, AP, DV from bregma, to the
 * right, anterior, dorsal. They need a frame in CCF or from bregma. */
conus_status pose_ibl_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);

#endif
