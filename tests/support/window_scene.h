/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A window without a screen, on an atlas of areas one inside the other. */
#ifndef CONUS_TESTS_SUPPORT_WINDOW_SCENE_H
#define CONUS_TESTS_SUPPORT_WINDOW_SCENE_H

#include "viewer/window/window.h"

/** Writes and opens the phantom "nested"; @p viewer is to be ended by viewer_finish(). */
void window_scene_open(struct window *out, struct viewer *viewer);
/** The same with another phantom. */
void window_scene_open_phantom(struct window *out, struct viewer *viewer, const char *phantom);

#endif
