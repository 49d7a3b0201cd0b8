/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that a key leaves, a session where it was before or, as pictures are, named by the time:
 * conus-20260131-154500.json, in the folder where conus was started. A second one in the same second gets a number,
 * none replaces another. */
#ifndef CONUS_VIEWER_SESSION_SAVE_FILE_H
#define CONUS_VIEWER_SESSION_SAVE_FILE_H

#include "viewer/window/window.h"

enum saved_file { SAVE_SESSION = 0, SAVE_SAME_SESSION, SAVE_PICTURE, SAVE_RESULTS, SAVE_STUDY };

/** Writes it, and says where in the status line. A picture is what has just been drawn; the hits of the cone get a
 * sidecar. */
void save_file(struct window *window, enum saved_file what);
/** Writes the session to window->files.saves_as, which is NULL then, and says so. */
void save_file_as(struct window *window);

#endif
