/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lead-DBS's reconstructions of electrodes. */
#ifndef CONUS_POSES_PROGRAMS_POSE_LEAD_DBS_H
#define CONUS_POSES_PROGRAMS_POSE_LEAD_DBS_H

#include "poses/rows/pose_list.h"

/* Texts are no longer than pose_memory(). */

/** The contacts of a reconstruction, ea_reconstruction.mat or *_desc-reconstruction.mat, as points in MNI space, or in
 * the patient's own where it has no other. */
conus_status pose_lead_dbs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** The same in the patient's own space. */
conus_status pose_lead_dbs_parse_native(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** Sets *found where the MAT-file @p text is a reconstruction. Errors are those of the file. */
conus_status pose_lead_dbs_find(bool *found, struct text text, const conus_pose_options *options);

#endif
