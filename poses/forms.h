/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What programs write: how their files begin. */
#ifndef CONUS_POSES_FORMS_H
#define CONUS_POSES_FORMS_H

#include "base/text.h"
#include "conus/pose_file.h"

/** The format of a text by its first line with data, which ends behind *used bytes; CONUS_POSE_FORMAT_AUTO while that
 * is not @p all there. JSON is CONUS_POSE_FORMAT_MARKUPS and MATLAB's binary CONUS_POSE_FORMAT_SIMNIBS, whichever
 * program wrote it; CONUS_POSE_FORMAT_TABLE is whatever is delimited text. */
conus_pose_format forms_find(struct text text, bool all, size_t *used);

/** Why a text with these first bytes holds no poses; NULL if they do not show that. */
const char *forms_why_none(struct text text);

#endif
