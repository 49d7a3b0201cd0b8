/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts about figures. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_FIGURE_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_FIGURE_H

#include "viewer/window/window.h"

/** The 3-D view at a size of 1 to 16384 pixels, with the sheet as conus render has it by itself; false where that
 * fails, which stderr says. */
bool script_picture(struct window *window, const char *path, const double size[2]);

/** Both get their @p count arguments, as many as the table of commands allows; false where they are wrong. */
bool script_sheet(struct window *window, char *const *arguments, size_t count);
bool script_figure(struct window *window, char *const *arguments, size_t count);

#endif
