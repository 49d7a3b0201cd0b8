/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Brainsight's export. */
#ifndef CONUS_POSES_PROGRAMS_POSE_BRAINSIGHT_H
#define CONUS_POSES_PROGRAMS_POSE_BRAINSIGHT_H

#include "poses/rows/pose_list.h"

/** Brainsight's export: sections of targets, samples and electrodes; landmarks are passed over. */
conus_status pose_brainsight_parse(conus_pose_list *list, struct text text, const conus_pose_options *options);
/** Whether a line that begins with # is one of Brainsight's, not a comment. */
bool pose_brainsight_line(struct text line);

#endif
