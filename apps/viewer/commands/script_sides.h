/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts about left and right areas. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_SIDES_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_SIDES_H

#include "viewer/window/window.h"

/** Both get their @p count arguments, as many as the table of commands allows; false where they are wrong. */
bool script_hemispheres(struct window *window, char *const *arguments, size_t count);
bool script_side(struct window *window, char *const *arguments, size_t count);

#endif
