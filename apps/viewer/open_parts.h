/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What open.c opens with, for open_all.c. */
#ifndef CONUS_VIEWER_OPEN_PARTS_H
#define CONUS_VIEWER_OPEN_PARTS_H

#include "viewer/loader.h"
#include "viewer/view_settings.h"
#include "viewer/window/window.h"

/** Loads, while the window says how far that is. False: nobody wants them any more, or @p why has the reason. */
bool open_load(struct window *window, const struct loading *what, struct atlases *out, char why[LOADER_WHY]);
/** Opens what the user named, a path or an installed atlas, whose path is what is remembered, if it is to be. */
bool open_named(struct window *window, const char *text, const struct view_settings *settings, bool remember,
                char why[LOADER_WHY]);
/** Opens what is named, a session or an atlas, or the atlas that a session waits for. */
bool open_either(struct window *window, const char *path, const struct view_settings *settings, bool with_options,
                 char why[LOADER_WHY]);
/** Leaves out options that were for another atlas, which may be of another brain, with other names. */
void open_leave_options(struct view_settings *settings);

#endif
