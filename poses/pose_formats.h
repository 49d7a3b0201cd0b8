/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of poses: a table of their parsers, and how they are recognised. */
#ifndef CONUS_POSES_POSE_FORMATS_H
#define CONUS_POSES_POSE_FORMATS_H

#include "conus/pose_file.h"
#include "poses/rows/pose_list.h"

/** Parses a text as a whole (pose_programs.h). */
typedef conus_status (*pose_parser)(conus_pose_list *list, struct text text, const conus_pose_options *options);

/** NULL of a format that is read line by line. */
pose_parser pose_format_parser(conus_pose_format format);

/** The format of the first line with data, which ends behind *used bytes; CONUS_POSE_FORMAT_AUTO while it is not @p
 * all there. JSON is CONUS_POSE_FORMAT_MARKUPS and MATLAB's binary CONUS_POSE_FORMAT_SIMNIBS, whichever program wrote
 * it. */
conus_pose_format pose_format_guess(struct text text, bool all, size_t *used);

/** Where @p text is a MAT-file of another program than SimNIBS, sets *format and reads it into @p list, as its parser
 * does: of level 7.3 another process reads the file, which takes longer than the rest. */
conus_status pose_format_of_matlab(conus_pose_format *format, conus_pose_list *list, struct text text,
                                   const conus_pose_options *options);

/** Why a text with these first bytes holds no poses, for the user; NULL if they do not show that. */
const char *pose_format_refused(struct text text);

#endif
