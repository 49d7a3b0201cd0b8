/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Lines over pictures: each has a dark edge, so that it is seen on white as on black. Pixels of the window. */
#ifndef CONUS_VIEWER_PANES_STROKES_H
#define CONUS_VIEWER_PANES_STROKES_H

#include "viewer/ui/ui.h"

struct pen {
    ui_colour colour;
    float width; /**< Without the edges, at scale 1. */
    float scale; /**< The window's. */
};

void stroke_line(const float from[2], const float to[2], struct pen pen);
/** Dashes; @p phase, 0 at first, goes on where several lines are one behind the other. */
void stroke_dashes(float *phase, const float from[2], const float to[2], struct pen pen);
/** A ring; @p radius at scale 1. */
void stroke_circle(const float centre[2], float radius, struct pen pen);

#endif
