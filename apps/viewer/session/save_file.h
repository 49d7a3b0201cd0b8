/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that a user saves: a session where it was before, all else where the dialog was told, which proposes a
 * name by the time: conus-20260131-154500.json. */
#ifndef CONUS_VIEWER_SESSION_SAVE_FILE_H
#define CONUS_VIEWER_SESSION_SAVE_FILE_H

#include "viewer/window/window.h"

/** Asks where, unless it is a session that has a file. */
void save_file(struct window *window, enum saved_file what);
/** Writes window->files.saves to window->files.saves_as, which is NULL then, and says so. A picture is what has just
 * been drawn; the hits of the cone get a sidecar. */
void save_file_as(struct window *window);

#endif
