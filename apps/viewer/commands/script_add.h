/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts that open files and add them to the atlas. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_ADD_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_ADD_H

#include "viewer/window/window.h"

/** drop PATH..., type PATH, context FILE, pathway FILE, streamlines FILE, take-out FILE: @p words are the command's
 * name and @p count arguments. What cannot be opened or added is said by the window, as with the mouse. */
bool script_add(struct window *window, char *const *words, size_t count);

#endif
