/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All devices of the window, and what they said last to each of its two tools. */
#ifndef CONUS_VIEWER_DEVICES_DEVICES_H
#define CONUS_VIEWER_DEVICES_DEVICES_H

#include "viewer/devices/gamepad.h"
#include "viewer/devices/pushed.h"
#include "viewer/devices/spacemouse.h"
#include "viewer/devices/tracker.h"

struct devices {
    struct tracker trackers[2]; /**< Of the first and the second tool. */
    struct pushed mouse;
    struct spacemouse spacemouse;
    struct gamepad gamepad;
    struct source_news heard[2]; /**< What moves either tool, when it was asked last. */
};

void devices_init(struct devices *out);
void devices_finish(struct devices *devices);
/** Of SpaceMouse and gamepad: mm and degrees a second at most, from SOURCE_LEAST_SPEED to SOURCE_MOST_SPEED. */
double devices_speed(const struct devices *devices);
void devices_set_speed(struct devices *devices, double speed);

#endif
