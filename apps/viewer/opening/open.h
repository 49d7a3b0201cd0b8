/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Opens one atlas after the other in the same window. */
#ifndef CONUS_VIEWER_OPEN_H
#define CONUS_VIEWER_OPEN_H

#include "viewer/opening/loader.h"
#include "viewer/opening/view_words.h"
#include "viewer/window/window.h"

/** Begins to load @p path on another thread, before there is a window: for open_requested(). NULL: nothing is begun. */
struct loader *open_begin(const char *path, const struct view_settings *settings);
/** Opens window->files.requested in place of what is open, or adds it; @p begun is the clock from which times count.
 * With @p with_options, where nothing is open, all @p settings apply; else not those for one atlas: labels, pathways,
 * hidden objects, context, transfer function, session, space. False: window and atlas stay as they were. Then stderr
 * and the window say why, and *failed is set; or the window was closed, or the user wants something else meanwhile. */
bool open_requested(struct window *window, const struct view_settings *settings, bool with_options, double begun,
                    bool *failed);
/** Loads --poses, in the space of @p frame. Returns the exit code and prints an error unless it is 0. */
int open_poses(struct window *window, const struct view_settings *settings, const conus_frame *frame);
/** Closes the atlas, if there is one. */
void open_finish(struct window *window);

#endif
