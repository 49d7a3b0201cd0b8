/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether positions look as if they were in metres. */
#ifndef CONUS_POSES_ROWS_POSE_EXTENT_H
#define CONUS_POSES_ROWS_POSE_EXTENT_H

#include "base/notes.h"

/** The box around positions. All 0: of none. */
struct pose_extent {
    size_t count;
    double low[3], high[3]; /**< mm. */
    double farthest;        /**< Largest distance from the origin, mm. */
};

/** Counts a row's position; a row with an error has none. */
void pose_extent_add(struct pose_extent *extent, const conus_pose_row *row);

/** A warning where a head in metres would be as small: all positions lie within 1 mm of the origin, or three and more
 * within 0.2 mm of each other. They must differ, or at least not be at the origin. @p source is the file that says that
 * they are in mm, "" if none does. */
conus_status pose_extent_note(struct notes *notes, const struct pose_extent *extent, const char *source);

#endif
