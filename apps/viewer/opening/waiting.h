/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The page that is shown while files are read, on a thread of their own. */
#ifndef CONUS_VIEWER_OPENING_WAITING_H
#define CONUS_VIEWER_OPENING_WAITING_H

#include "viewer/opening/loader.h"
#include "viewer/window/window.h"

/** Ends what open_begin() began and wait_load() did not wait for. */
void wait_leave(struct window *window);
/** Loads, or continues what was begun, while the window shows the progress, unless it is quick. False: the user
 * cancelled, or @p why has the reason. */
bool wait_load(struct window *window, const struct loading *request, struct atlases *out, char why[LOADER_WHY]);
/** Calls @p look on the loader's thread, which looks at the file @p path and others, and waits likewise. */
bool wait_look(struct window *window, const char *path, void (*look)(void *user), void *user, char why[LOADER_WHY]);

#endif
