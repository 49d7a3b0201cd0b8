/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts about how the atlas looks. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_LOOK_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_LOOK_H

#include "viewer/window/window.h"

/** Each gets its @p count arguments, as many as the table of commands allows; false where they are wrong. */
bool script_threshold(struct window *window, char *const *arguments, size_t count);
bool script_fade(struct window *window, char *const *arguments, size_t count);
bool script_grey(struct window *window, char *const *arguments, size_t count);
bool script_opacity(struct window *window, char *const *arguments, size_t count);
bool script_haze(struct window *window, char *const *arguments, size_t count);
bool script_streamlines(struct window *window, char *const *arguments, size_t count);
bool script_preset(struct window *window, char *const *arguments, size_t count);
bool script_background(struct window *window, char *const *arguments, size_t count);

#endif
