/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What moves the two tools, and a head, besides the panels: the mouse, trackers, devices, a file of poses. */
#ifndef CONUS_VIEWER_TOOLS_INPUTS_H
#define CONUS_VIEWER_TOOLS_INPUTS_H

#include "viewer/devices/devices.h"
#include "viewer/model/source.h"

struct inputs {
    struct replay replay;
    struct station *station; /**< NULL = none. */
    struct station_news news;
    struct station *second_station; /**< Of the second tool; NULL = the first one's. */
    bool has_second_tool;           /**< The first one's station hears of it. */
    struct devices devices;
};

/** Has the newest pose of each tracked tool, and every other device that moves a tool, heard, and the second tool's
 * answers up to date. Returns whether the first one got a pose. */
bool inputs_step(struct inputs *inputs, struct viewer *viewer, double now_s);
/** Seconds until devices that cannot wake the window are to be asked again; INFINITY where none moves a tool. */
double inputs_rest(const struct inputs *inputs, const struct viewer *viewer);
/** Lets the mouse point along a ray from the eye (point.h) with the tool that it moves. */
void inputs_point(struct inputs *inputs, struct viewer *viewer, const double eye[3], const double direction[3]);

/** Moves and turns a tool along its own axes (steer.h); where it has no pose, it is placed first. */
void tool_steer(struct viewer *viewer, enum tool_number number, const double move[3], const double turn[3]);

/** What the window says of a tool: that it is held, that it is not there yet, that its tracker is gone. */
struct notice {
    const char *text; /**< One line; NULL = there is nothing to say. */
    bool is_trouble;  /**< The cone is not, or no longer, where its tool is. */
    bool is_old;      /**< So the answer is one from before. */
};
void inputs_notice(struct notice *out, const struct inputs *inputs, const struct viewer *viewer,
                   enum tool_number number);

#endif
