/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Draws one frame: all panels and panes. */
#ifndef CONUS_VIEWER_DRAW_H
#define CONUS_VIEWER_DRAW_H

#include "viewer/window/window.h"

/** Draws one frame of @p window->viewer, or of the start page. */
void draw_window(struct window *window);

#endif
