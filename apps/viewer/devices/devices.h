/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All devices of the window, and what they said last to each of its two tools. */
#ifndef CONUS_VIEWER_DEVICES_DEVICES_H
#define CONUS_VIEWER_DEVICES_DEVICES_H

#include "link/station.h"
#include "viewer/devices/source.h"

#include <math.h>

struct pushed {
    struct source source; /**< First: a pointer to it is one to this. */
    conus_pose pose;
    bool is_new;
};

/** Puts the pose that is answered next. */
void pushed_put(struct pushed *pushed, const conus_pose *pose);

struct tracker {
    struct source source; /**< First: a pointer to it is one to the tracker. */
    struct station_tool tool;
    uint64_t taken; /**< Number of the pose that was answered last. */
    bool is_there;  /**< There is a station for it. */
};

/** Takes over what the station says of its tool; NULL = there is no station. */
void tracker_hear(struct tracker *tracker, const struct station_tool *tool);

/** The state of a gamepad now. */
struct gamepad_reading {
    enum { GAMEPAD_NONE = 0, GAMEPAD_UNKNOWN /**< A joystick without a known layout. */, GAMEPAD_THERE } presence;
    double left[2], right[2]; /**< Sticks, -1 to 1: to the right, towards the user. */
    double triggers[2];       /**< Left and right, 0 to 1. */
    bool up, down;            /**< Right and left shoulder. */
    unsigned pressed;         /**< Bits of source_press that are down. */
};

/** Its sticks move and turn the tool along the tool's own axes, its triggers change the angle. */
struct gamepad {
    struct source source; /**< First: a pointer to it is one to the gamepad. */
    void (*read)(struct gamepad_reading *reading);
    unsigned pressed; /**< Before. */
    bool was_there;
    double asked_s;
};

/** Reads by @p read. */
void gamepad_init(struct gamepad *out, void (*read)(struct gamepad_reading *reading));
/** Reads the first gamepad that GLFW knows; on the window's thread. */
void gamepad_read(struct gamepad_reading *out);

/** By the program spacenavd and libspnav: its cap moves and turns the tool along the tool's own axes. One at a time in
 * a program, since libspnav has one connection. */
struct spacemouse {
    struct source source; /**< First: a pointer to it is one to the SpaceMouse. */
    bool is_open, is_heard, is_unplugged;
    int axes[6]; /**< x, y, z and turns about them, as spacenavd has them: +z away from who sits before it. */
    double moved_s, asked_s,
        tried_s; /**< By the clock of source_ask(): when it last moved, was asked, was looked for. */
};

/** Connects when it is asked first, and again every 2 s while spacenavd does not answer. */
void spacemouse_init(struct spacemouse *out);
void spacemouse_finish(struct spacemouse *mouse);

struct devices {
    struct tracker trackers[2]; /**< For the first and the second tool. */
    struct pushed mouse;
    struct spacemouse spacemouse;
    struct gamepad gamepad;
    struct source_update heard[2]; /**< The last answers of the sources that move the tools. */
};

void devices_init(struct devices *out);
void devices_finish(struct devices *devices);
/** The speed of SpaceMouse and gamepad, mm and degrees a second, SOURCE_LEAST_SPEED to SOURCE_MOST_SPEED. */
static inline double devices_speed(const struct devices *devices)
{
    return source_speed(&devices->gamepad.source);
}
static inline void devices_set_speed(struct devices *devices, double speed)
{
    double bounded = fmin(fmax(speed, SOURCE_LEAST_SPEED), SOURCE_MOST_SPEED);
    devices->gamepad.source.speed = devices->spacemouse.source.speed = bounded;
}

#endif
