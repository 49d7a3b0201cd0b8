/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The keyboard in place of the mouse: keys that go to the widgets of a panel. */
#ifndef CONUS_VIEWER_UI_UI_NAVIGATE_H
#define CONUS_VIEWER_UI_UI_NAVIGATE_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** From this frame on the arrow keys, Tab, Space and Enter go to the widgets of the panel with this title; NULL = to
 * none. Between ui_begin() and ui_end(). */
void ui_navigate(const char *title);
bool ui_navigates(void);
/** For the frame that begins next a key of GLFW is down, or up again. Without that, one that is pressed and let go
 * between two frames does nothing. */
void ui_hold_key(int key, bool down);
/** Whether Escape is for the widgets: a choice or a list that was entered, a number that is typed. */
bool ui_navigates_deep(void);

#ifdef __cplusplus
}
#endif

#endif
