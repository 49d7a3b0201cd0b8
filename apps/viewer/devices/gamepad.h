/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A gamepad as a source: its sticks move and turn the tool along the tool's own axes, its triggers change the
 * angle. */
#ifndef CONUS_VIEWER_DEVICES_GAMEPAD_H
#define CONUS_VIEWER_DEVICES_GAMEPAD_H

#include "viewer/devices/source.h"

/** The state of a gamepad now. */
struct gamepad_reading {
    enum { GAMEPAD_NONE = 0, GAMEPAD_UNKNOWN /**< A joystick without a known layout. */, GAMEPAD_THERE } presence;
    double left[2], right[2]; /**< Sticks, -1 to 1: to the right, towards the user. */
    double triggers[2];       /**< Left and right, 0 to 1. */
    bool up, down;            /**< Right and left shoulder. */
    unsigned pressed;         /**< Bits of source_press that are down. */
};

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

#endif
