/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that are no text. */
#ifndef CONUS_POSES_POSE_BYTES_H
#define CONUS_POSES_POSE_BYTES_H

#include "base/text.h"
#include "conus/conus.h"

/** What the first bytes show not to be poses, as it is said to the user; NULL if nothing. */
const char *pose_bytes_kind(struct text text);

/** Whose file of MATLAB @p text is; *format stays for other texts. Errors are those of the file. */
conus_status pose_bytes_program(conus_pose_format *format, struct text text, const conus_pose_options *options);

#endif
