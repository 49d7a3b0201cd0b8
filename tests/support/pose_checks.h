/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reading poses, of samples (tests/fuzz/corpus/poses) and of texts, and checking their rows. */
#ifndef CONUS_TESTS_SUPPORT_POSE_CHECKS_H
#define CONUS_TESTS_SUPPORT_POSE_CHECKS_H

#include "base/text.h"
#include "conus/pose.h"

/** The devices of the samples are 80 mm from here and look at it: (0, -20, 10). */
extern const double pose_target[3];

/** Path of a sample. Static buffer. */
const char *pose_sample(const char *name);

conus_pose_list *pose_sample_load(const char *name, const conus_pose_options *options);
conus_pose_list *pose_text_parse(struct text text, const conus_pose_options *options);

/** Fails unless @p text is refused as data with a message that has @p part. */
void pose_text_refuse(struct text text, const conus_pose_options *options, const char *part);

/** Row @p index, which is called @p id. */
const conus_pose_row *pose_row_of(const conus_pose_list *list, size_t index, const char *id);

/** Fails unless the error of that row has @p part in it. */
void assert_row_fails(const conus_pose_list *list, size_t index, const char *id, const char *part);

/** Fails unless the row is at this position within 1e-9 mm, or points along this unit vector within 1e-9. */
void assert_row_at(const conus_pose_row *row, double x, double y, double z);
void assert_row_along(const conus_pose_row *row, double x, double y, double z);

/** Fails unless the beam passes the target within @p tolerance mm, 80 mm ahead, not behind. */
void assert_row_at_target(const conus_pose_row *row, double tolerance);

bool pose_has_note(const conus_pose_list *list, const char *part);

#endif
