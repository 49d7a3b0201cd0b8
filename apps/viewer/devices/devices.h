/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Devices that move the two tools of the window, and the interface that each of them has. */
#ifndef CONUS_VIEWER_DEVICES_DEVICES_H
#define CONUS_VIEWER_DEVICES_DEVICES_H

#include "conus/pose.h"
#include "link/station.h"

#include <math.h>

/* A source moves a tool: a device behind one question. It answers with a pose in the world, or with moves along the
 * tool's own axes, and says how it is. One thread, the window's. */

enum source_state {
    SOURCE_NONE = 0, /**< No such device: it was not asked for, or this build has no support for it. */
    SOURCE_ABSENT,   /**< Not there, or unplugged. */
    SOURCE_SILENT,   /**< There, but it has said nothing yet. */
    SOURCE_LOST,     /**< The tracker does not see the tool. */
    SOURCE_STALE,    /**< It has stopped to say where the tool is. */
    SOURCE_BROKEN,   /**< It says what are no numbers. */
    SOURCE_FROZEN,   /**< It has said the same, to the last bit, for SOURCE_FROZEN_S. */
    SOURCE_WELL
};

/** Bits of the buttons that were pressed. */
enum source_press { SOURCE_HOLD = 1, SOURCE_RESET = 2, SOURCE_CONFIRM = 4 };

enum { SOURCE_FROZEN_S = 5, SOURCE_VALUES = 16 };

/** A source's events since it was asked last. All 0: none. */
struct source_update {
    enum source_state state;
    bool has_pose;
    conus_pose pose;  /**< The device's pose in the world, if it has one. */
    double move[3];   /**< mm along the tool's x, y, z. */
    double turn[3];   /**< Radians, a rotation vector in the tool's frame. */
    double widen;     /**< The cone's angle times that; 0 = it stays. */
    unsigned pressed; /**< Bits of source_press. */
    const char *text; /**< The trouble, one line; NULL = none that it knows. */
};

/** The last raw values of a device, to find one that is frozen. */
struct source_watch {
    double values[SOURCE_VALUES];
    double since_s; /**< By the clock of source_ask(). */
    bool any;
};

struct source {
    /** Answers; @p now_s is a monotonic clock. It fills @p said, [SOURCE_VALUES], where the device said something that
     * a hand or a noise would change, and returns whether it did. */
    bool (*ask)(struct source *source, double now_s, struct source_update *out, double said[SOURCE_VALUES]);
    struct source_watch watch;
    double speed; /**< If the source sends moves: mm and degrees a second at most; 0 = SOURCE_SPEED. */
};

enum { SOURCE_SPEED = 40, SOURCE_LEAST_SPEED = 1, SOURCE_MOST_SPEED = 400 };
double source_speed(const struct source *source);

/** Asks a source. What are no numbers, and moves of one that is frozen, are left out, and the state says so. NULL, or
 * one without its function, is a source that is not there. */
void source_ask(struct source *source, double now_s, struct source_update *out);

/* All devices of the window, and what they said last to each of its two tools. */

struct pushed {
    struct source source; /**< First: a pointer to it is one to this. */
    conus_pose pose;      /**< That is answered next. */
    bool is_new;
};

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
    bool is_open, has_event, is_unplugged;
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
    struct source_update received[2]; /**< The last answers of the sources that move the tools. */
};

void devices_init(struct devices *out);
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
