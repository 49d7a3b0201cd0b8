/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts about a tracked head. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_HEAD_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_HEAD_H

#include "viewer/window/window.h"

/** Where the screen stands, by eight numbers: its middle, a point behind it in the line of sight, its width and height;
 * false where they are wrong. */
bool script_screen(struct viewer *viewer, char *const *arguments);

/** The eye is at the three numbers now, or the tracker has lost it ("lost"); false where they are wrong. */
bool script_head(struct viewer *viewer, char *const *arguments, size_t count);

#endif
