/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What an eye sees in a picture, and where things lie in it: of the pane's own eye (orbit.h), or of a tracked
 * head's (head.h). World RAS+, mm. */
#ifndef CONUS_VIEWER_MODEL_SIGHT_H
#define CONUS_VIEWER_MODEL_SIGHT_H

#include "viewer/pictures/orbit.h"

/** As conus_view has it. */
struct sight {
    conus_pose camera; /**< Looks down its own -z, +y up.                               */
    double frustum[4]; /**< The picture's left, right, lower and upper edge at depth 1. */
};

/** Of a picture of width x height pixels. */
void sight_of_orbit(struct sight *out, const struct orbit *orbit, const double size[2]);
/** Whether both see the same. */
bool sight_is_same(const struct sight *a, const struct sight *b);
/** Takes as much to the left and right as square pixels of a picture of that size need. */
void sight_fit(struct sight *sight, const double size[2]);

/** Where the world point @p p lies in a picture of width x height pixels: x right, y down from the top left. False
 * behind the eye. */
bool sight_project(double out[2], const struct sight *sight, const double size[2], const double p[3]);
/** The unit direction from the eye through a point of such a picture. */
void sight_ray(double direction[3], const struct sight *sight, const double size[2], const double at[2]);

#endif
