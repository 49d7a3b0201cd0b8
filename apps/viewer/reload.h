/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Loads the atlases again with other hemispheres while the window goes on with those that it has, and then shows
 * them in their place. */
#ifndef CONUS_VIEWER_RELOAD_H
#define CONUS_VIEWER_RELOAD_H

#include "viewer/window/window.h"

/** Begins, goes on, or ends, as window->hemispheres says. Where it fails, all stays as it was, and one line says why on
 * stderr and in the window. */
void reload_step(struct window *window);
/** Ends it, if it goes on; what was wanted is not any more. Waits for the file that is being read. */
void reload_end(struct window *window);

#endif
