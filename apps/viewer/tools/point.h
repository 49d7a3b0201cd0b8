/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The pose of a ray through the mouse: where the cone's apex is. World RAS+, mm. */
#ifndef CONUS_VIEWER_TOOLS_POINT_H
#define CONUS_VIEWER_TOOLS_POINT_H

#include "viewer/model/viewer.h"

/** How far it is from @p from along the unit vector @p direction to the surface of what is shown: to the context of the
 * drawn atlas, a head's skin, or to the first object of any atlas, whichever is nearer. INFINITY beside them. */
double point_depth(struct viewer *viewer, const double from[3], const double direction[3]);

/** The pose that the mouse gives by a ray from the eye that goes through it: from the surface, or from the eye itself
 * where the cone has its apex there. False where the ray passes beside all surfaces. */
bool point_find(conus_pose *out, struct viewer *viewer, const double eye[3], const double direction[3]);

/** How far before the surface the mouse's cone begins, mm, where it does so: 40, or half the radius of a small atlas. A
 * cone whose range has an end begins on the surface then: its depths are told from there. */
double point_before(const struct viewer *viewer);

#endif
