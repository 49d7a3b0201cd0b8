/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How far a tool's cone reaches, and how it is turned about the place where it comes into the brain. World RAS+,
 * mm. */
#ifndef CONUS_VIEWER_TOOLS_EXTENT_H
#define CONUS_VIEWER_TOOLS_EXTENT_H

#include "viewer/model/viewer.h"

struct extent {
    double entry[3]; /**< Where the axis, from far before the apex, comes into what is shown (point.h); beside that its
                          place that is nearest to the middle. */
    double reach;    /**< Its ball is so far before the entry, or nearer where that is not seen: 40, or half the radius
                          of a small atlas; beside what is shown outside of all. */
    double near;     /**< Depths along the axis from the apex: the cone begins, */
    double first;    /**< has its nearest hit, else it ends there, */
    double solid;    /**< has its deepest hit, where only first hits count, else it ends there, */
    double end;      /**< and ends: its range does, or else its axis leaves what is shown, with all layers all rays. */
};

/** Finds it for a tool that has a pose. */
void extent_find(struct extent *out, struct viewer *viewer, enum tool_number number);

/** Where the ball is. */
void extent_ball(double out[3], const struct extent *extent, const conus_pose *pose);

/** Turns a tool about the entry, so that its ball is seen along the ray from @p eye along the unit vector @p direction,
 * on the side on which it is; beside all such places as near to the ray as it can be. */
void extent_turn(struct viewer *viewer, enum tool_number number, const struct extent *extent, const double eye[3],
                 const double direction[3]);

#endif
