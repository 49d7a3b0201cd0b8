/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The wall of a cone, a range of one or a cylinder, between two rings of points, drawn as lines. World, mm. */
#ifndef CONUS_VIEWER_TOOLS_SHELL_H
#define CONUS_VIEWER_TOOLS_SHELL_H

#include "conus/pose.h"

#include <stddef.h>

enum { SHELL_POINTS = 64 };

struct shell {
    double near[SHELL_POINTS][3],
        far[SHELL_POINTS][3];    /**< Each near point and its far point are on one line of the wall. */
    double out[SHELL_POINTS][3]; /**< Unit normals of the wall there. */
};

/** Finds the wall at @p pose between two depths along the axis: @p radius at the apex, 0 of a cone, and the full
 * opening
 * @p angle, degrees, 0 of a cylinder. */
void shell_find(struct shell *out, const conus_pose *pose, double radius, double angle, double near, double far);

/** A straight piece of the wall in a plane. */
struct shell_piece {
    double ends[2][3];
};

/** Where the plane through @p at with the unit normal @p normal cuts the wall; returns how many pieces that are. */
size_t shell_cut(struct shell_piece out[2 * SHELL_POINTS], const struct shell *shell, const double at[3],
                 const double normal[3]);

/** Whether the wall is seen from the side by @p eye between points @p i and i + 1: there is its outline. */
bool shell_turns(const struct shell *shell, size_t i, const double eye[3]);

#endif
