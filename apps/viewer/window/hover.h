/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The names of what is under the mouse. */
#ifndef CONUS_VIEWER_WINDOW_HOVER_H
#define CONUS_VIEWER_WINDOW_HOVER_H

#include "viewer/window/window.h"

enum { HOVER_TEXT = 1024 };

/** Name and, of a pathway, value of what is under the mouse; "" = nothing. Of several atlases "ATLAS: NAME" of each,
 * with
 * @p between between them, also where the mouse is nowhere: at the crosshair. What is under the mouse in an atlas that
 * is not drawn is what would be there if it were; in 3-D with how much farther from the eye it is than in the drawn
 * one. */
void hover_text(char out[HOVER_TEXT], const struct window *window, const char *between);
/** The same over the widget before, where the mouse is on it. */
void hover_tip(const struct window *window);

#endif
