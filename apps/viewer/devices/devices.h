/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All devices of the window, and what they said last to each of its two tools. */
#ifndef CONUS_VIEWER_DEVICES_DEVICES_H
#define CONUS_VIEWER_DEVICES_DEVICES_H

#include "link/station.h"
#include "viewer/devices/gamepad.h"
#include "viewer/devices/source.h"
#include "viewer/devices/spacemouse.h"

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

struct devices {
    struct tracker trackers[2]; /**< For the first and the second tool. */
    struct pushed mouse;
    struct spacemouse spacemouse;
    struct gamepad gamepad;
    struct source_update heard[2]; /**< The last answers of the sources that move the tools. */
};

void devices_init(struct devices *out);
void devices_finish(struct devices *devices);
/** The speed of SpaceMouse and gamepad: mm and degrees a second at most, from SOURCE_LEAST_SPEED to SOURCE_MOST_SPEED.
 */
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
