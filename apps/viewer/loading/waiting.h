/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The page that is shown while files are read, on a thread of their own. */
#ifndef CONUS_VIEWER_LOADING_WAITING_H
#define CONUS_VIEWER_LOADING_WAITING_H

#include "viewer/loading/loader.h"
#include "viewer/window/window.h"

/** Loads, while the window says how far that is. False: nobody wants them any more, or @p why has the reason. */
bool wait_load(struct window *window, const struct loading *what, struct atlases *out, char why[LOADER_WHY]);
/** Likewise calls @p look with @p user on the other thread, which looks at the file @p path and others. */
bool wait_look(struct window *window, const char *path, void (*look)(void *user), void *user, char why[LOADER_WHY]);

#endif
