/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a pane shows as a file, at any size, as conus render would draw it. */
#ifndef CONUS_VIEWER_WINDOW_FIGURE_FILE_H
#define CONUS_VIEWER_WINDOW_FIGURE_FILE_H

#include "figures/figure.h"
#include "viewer/window/window.h"

enum { FIGURE_REASON = 512 };

/** What of conus render's options the window's sheet and background mean. */
void figure_of_window(struct figure_settings *out, const struct window *window);

/** Draws @p pane (PANE_3D, or a plane) with the look, the cone and the place that it has now, and writes it. In 3-D a
 * shape other than the pane's shows more or less to the left and right. False where that fails, and @p why says it. */
bool figure_write(const struct window *window, size_t pane, const struct figure_settings *settings, const char *path,
                  char why[FIGURE_REASON]);

#endif
