/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Either tool of the window, whichever it is: what moves, holds and resets it is the same. */
#ifndef CONUS_VIEWER_TOOLS_TOOL_H
#define CONUS_VIEWER_TOOLS_TOOL_H

#include "viewer/devices/source.h"
#include "viewer/tools/second.h"

struct tool {
    struct viewer *viewer;
    struct second *second; /**< NULL = the first tool, which is the viewer's own. */
};

enum pointer tool_pointer(const struct tool *tool);
bool tool_is_held(const struct tool *tool);
const conus_pose *tool_pose(const struct tool *tool); /**< NULL = it has none. */
void tool_aim(const struct tool *tool, const conus_pose *pose);
/** Holds it where it is, or lets it go; without a pose there is nothing to hold. */
void tool_hold(const struct tool *tool);
/** Its angle times @p factor, from 0.1 to 179 degrees. */
void tool_widen(const struct tool *tool, double factor);
/** Puts it where it is to start, looking at the brain's middle: the first before the face, the second to the right. */
void tool_place(const struct tool *tool);
/** Moves and turns it along its own axes (steer.h); where it has no pose, it is placed first. */
void tool_steer(const struct tool *tool, const double move[3], const double turn[3]);
/** Pins the best hit of its cone in the drawn atlas. */
void tool_confirm(const struct tool *tool);

/** Does what a source has said. Returns whether there was a pose, or a move. */
bool tool_take(const struct tool *tool, const struct source_news *news);

#endif
