/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The screen that the window is on. */
#ifndef CONUS_VIEWER_WINDOW_SCREEN_H
#define CONUS_VIEWER_WINDOW_SCREEN_H

#include "viewer/window/window.h"

/** The screen (GLFWmonitor) that the window's middle is on, and its x, y, width and height; NULL where none is known.
 */
void *window_screen(const struct window *window, int screen[4]);
/** Fits a place to what is free on the screen that its middle is on, else on the first one. */
void screen_fit(struct place *place);
/** How large texts shall be on the screen that the window is on; @p content as the desktop says. */
float window_screen_scale(const struct window *window, float content);
/** Lets the 3-D pane fill the screen that the window is on, without panels, or brings the window back. */
void window_fill_screen(struct window *window, bool fill);

/** What the 3-D pane is to show now: its own eye's view or, of a tracked head, that through its part of the screen. */
void window_sight(const struct window *window, struct sight *out);

#endif
