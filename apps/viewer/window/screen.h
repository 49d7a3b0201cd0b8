/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The screen that the window is on. */
#ifndef CONUS_VIEWER_WINDOW_SCREEN_H
#define CONUS_VIEWER_WINDOW_SCREEN_H

#include "viewer/window/window.h"

/** The screen (GLFWmonitor) that the window's middle is on, and its x, y, width and height; NULL where none is known.
 */
void *window_screen(const struct window *window, int screen[4]);
/** Lets the 3-D pane fill the screen that the window is on, without panels, or brings the window back. */
void window_fill_screen(struct window *window, bool fill);

/** What the 3-D pane is to show now: its own eye's view or, of a tracked head, that through its part of the screen. */
void window_sight(const struct window *window, struct sight *out);

#endif
