/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a text of poses begins with. */
#ifndef CONUS_POSES_POSE_GUESS_H
#define CONUS_POSES_POSE_GUESS_H

#include "base/text.h"
#include "conus/conus.h"

/** What the first line with data looks like, which ends behind *used bytes; CONUS_POSE_FORMAT_AUTO while it is not @p
 * all there. JSON is CONUS_POSE_FORMAT_MARKUPS and MATLAB's binary CONUS_POSE_FORMAT_SIMNIBS, whosever they are. */
conus_pose_format pose_guess_format(struct text text, bool all, size_t *used);

#endif
