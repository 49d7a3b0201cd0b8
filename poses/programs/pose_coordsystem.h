/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The space of a table of BIDS, of electrodes or of stimulation: its *_coordsystem.json. */
#ifndef CONUS_POSES_PROGRAMS_POSE_COORDSYSTEM_H
#define CONUS_POSES_PROGRAMS_POSE_COORDSYSTEM_H

#include "poses/rows/pose_list.h"

/** What a *_coordsystem.json says of positions: CONUS_ERROR_DATA for a space that is no image's world, and for units
 * that are no lengths. */
conus_status pose_coordsystem_parse(struct pose_space *out, struct text text);
/** Lets list->space be what the *_coordsystem.json beside the table @p path says, and list->coordsystem its path; or
 * else what the table's name says, with a note. */
conus_status pose_coordsystem_find(conus_pose_list *list, const char *path);

#endif
