/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Positions of non-invasive brain stimulation, as the proposal NIBS-BIDS (BEP037) has them. */
#ifndef CONUS_POSES_PROGRAMS_POSE_NIBS_H
#define CONUS_POSES_PROGRAMS_POSE_NIBS_H

#include "poses/rows/pose_list.h"

/** The proposal's *_markers.tsv, in units of list->space: poses, or points where there is only a target. */
conus_status pose_nibs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether @p line is the header of such a table. */
bool pose_nibs_header(struct text line);

#endif
