/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Files that a key leaves, a session where it was before or, as pictures are, named by the time:
 * conus-20260131-154500.json, in the folder where conus was started. A second one in the same second gets a number,
 * none replaces another. */
#ifndef CONUS_VIEWER_SESSION_KEEP_H
#define CONUS_VIEWER_SESSION_KEEP_H

#include "viewer/window/window.h"

enum keep { KEEP_SESSION = 0, KEEP_SAME_SESSION, KEEP_PICTURE, KEEP_RESULTS, KEEP_STUDY };

/** Writes it, and says where in the status line. A picture is what has just been drawn; the hits of the cone get a
 * sidecar. */
void keep(struct window *window, enum keep what);
/** Writes the session to window->files.saves_as, which is NULL then, and says so. */
void keep_as(struct window *window);

#endif
