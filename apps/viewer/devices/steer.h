/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Moves a pose along its own axes: -z is where it points, +y up. */
#ifndef CONUS_VIEWER_DEVICES_STEER_H
#define CONUS_VIEWER_DEVICES_STEER_H

#include <conus/conus.h>

/** Moves @p pose by @p move, mm along its axes, then turns it by @p turn, radians, a rotation vector in its frame. It
 * stays a rotation however often it is turned. */
void steer_pose(conus_pose *pose, const double move[3], const double turn[3]);

/** Brings a pose back that is farther than @p radius, mm, from @p centre, along the line to it. */
void steer_within(conus_pose *pose, const double centre[3], double radius);

#endif
