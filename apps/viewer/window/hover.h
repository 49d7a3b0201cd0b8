/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The names of what is under the mouse. */
#ifndef CONUS_VIEWER_WINDOW_HOVER_H
#define CONUS_VIEWER_WINDOW_HOVER_H

#include "viewer/window/window.h"

enum { HOVER_TEXT = 1024 };

/** Name and, of a pathway, value of what is under the mouse; "" = nothing. Of several atlases "ATLAS: NAME" of each,
 * and @p between in the gaps; where the mouse is nowhere, of what is at the crosshair. In an atlas that is not drawn it
 * is what would be under the mouse if it were; in 3-D with how much deeper or nearer that is than in the drawn one. */
void hover_text(char out[HOVER_TEXT], const struct window *window, const char *between);
/** Shows hover_text() as the tip of the widget before, where the mouse is on it. */
void hover_tip(const struct window *window);

#endif
