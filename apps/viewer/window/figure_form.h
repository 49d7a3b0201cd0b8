/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The question what is to be saved as a figure, and its answer. */
#ifndef CONUS_VIEWER_WINDOW_FIGURE_FORM_H
#define CONUS_VIEWER_WINDOW_FIGURE_FORM_H

#include "viewer/window/figure_file.h"

/** "3d", or a plane's name; [PANE_COUNT], by pane. */
extern const char *const figure_panes[PANE_COUNT];

/** Asks, with a name that is free: of the enlarged pane, or of the 3-D one. */
void figure_form_open(struct window *window);
/** Takes the answer: the file is written some frames later, so that the window can say so before. A file that is there
 * is replaced only when this is called again for it. A name without .png or .exr gets .png. */
void figure_form_save(struct window *window);
/** Once in each frame, after it was drawn. */
void figure_form_step(struct window *window);
/** Puts the path of the newest figure on the clipboard, as text. */
void figure_form_copy(struct window *window);

#endif
