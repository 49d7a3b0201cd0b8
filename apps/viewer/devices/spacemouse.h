/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A SpaceMouse as a source, by the program spacenavd and libspnav: its cap moves and turns the tool along the
 * tool's own axes. One at a time in a program, since libspnav has one connection. */
#ifndef CONUS_VIEWER_DEVICES_SPACEMOUSE_H
#define CONUS_VIEWER_DEVICES_SPACEMOUSE_H

#include "viewer/devices/source.h"

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

#endif
