/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A source moves a tool: a device behind one question. It answers with a pose in the world, or with moves along
 * the tool's own axes, and says how it is. One thread, the window's. */
#ifndef CONUS_VIEWER_DEVICES_SOURCE_H
#define CONUS_VIEWER_DEVICES_SOURCE_H

#include "conus/pose.h"

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

#endif
