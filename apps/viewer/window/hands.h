/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The two tools of the window, and the devices that move them. */
#ifndef CONUS_VIEWER_WINDOW_HANDS_H
#define CONUS_VIEWER_WINDOW_HANDS_H

#include "viewer/tools/notice.h"
#include "viewer/tools/tool.h"
#include "viewer/window/window.h"

enum hand { FIRST_HAND = 0, SECOND_HAND };

struct tool hands_tool(struct window *window, enum hand hand);
/** Of all that can move a tool, in the order of enum pointer, as panels, scripts and messages call it. */
extern const char *const hands_pointers[POINTER_COUNT];

/** Has a tool moved by @p pointer from now on; then nothing holds it. */
void hands_choose(struct window *window, enum hand hand, enum pointer pointer);
/** The next one of all that can move it. */
void hands_choose_next(struct window *window, enum hand hand);

/** Has the newest pose of each tracked tool, and every other device that moves a tool, heard, and the second tool's
 * answers up to date. Returns whether the first one got a pose. */
bool hands_step(struct window *window, double now_s);
/** Seconds until devices that cannot wake the window are to be asked again; INFINITY where none moves a tool. */
double hands_rest(const struct window *window);

/** The tool that @p pointer moves: the second one only where the first has another pointer. NULL viewer = none. */
struct tool hands_moved_by(struct window *window, enum pointer pointer);
/** Points by the mouse along a ray from the eye (point.h). */
void hands_point(struct window *window, const double eye[3], const double direction[3]);

/** What is to be said of either tool. */
void hands_notice(struct notice *out, const struct window *window, enum hand hand);

#endif
