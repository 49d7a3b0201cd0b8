/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The wall of a cone, a range of one or a cylinder, between two rings of points, drawn as lines. World, mm. */
#ifndef CONUS_VIEWER_TOOLS_SHELL_H
#define CONUS_VIEWER_TOOLS_SHELL_H

#include "conus/selection.h"

enum { SHELL_POINTS = 64 };

struct shell {
    double near[SHELL_POINTS][3],
        far[SHELL_POINTS][3];    /**< Each near point and its far point are on one line of the wall. */
    double out[SHELL_POINTS][3]; /**< Unit normals of the wall there. */
};

/** Finds the wall of the question (@p options, @p angle in radians, 0 = a cylinder) at @p pose; a cone without a range
 * ends
 * @p length mm from its apex. */
void shell_find(struct shell *out, const conus_pose *pose, const conus_selector_options *options, double angle,
                double length);

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
