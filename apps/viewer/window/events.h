/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What mouse and keyboard did, in its order. Several events may come between two frames, but in a frame the
 * mouse is at one place, and a key is down or not: so a frame takes only as many as it can tell apart. */
#ifndef CONUS_VIEWER_WINDOW_EVENTS_H
#define CONUS_VIEWER_WINDOW_EVENTS_H

#include "viewer/ui/ui.h"

struct window;

/** Events that no frame has taken yet. */
struct events {
    struct ui_event *list; /**< [count], with room for more; the window frees it. */
    size_t count, room;
    double time;   /**< Of those that the frame took, by glfwGetTime(); it may be some frames ago. */
    unsigned rest; /**< Frames that take none: a line that a key opened has the keyboard after them only. */
};

/** To be called for an open window: from now on its events are noted. */
void events_hear(struct window *window);
/** Takes those of the next frame: moves of the mouse up to a press, the press alone, ... Returns whether there are
 * more. */
bool events_take(struct window *window);

#endif
