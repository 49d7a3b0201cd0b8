/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The question what is to be saved as a figure, and its answer. */
#ifndef CONUS_VIEWER_WINDOW_FIGURE_FORM_H
#define CONUS_VIEWER_WINDOW_FIGURE_FORM_H

#include "figures/figure.h"
#include "viewer/window/window.h"

/** "3d", or a plane's name; [PANE_COUNT], by pane. */
extern const char *const figure_panes[PANE_COUNT];

/** Asks, with a name that is free: of the enlarged pane, or of the 3-D one. */
void figure_form_open(struct window *window);
/** Takes the answer: the file is written some frames later, so that the window can say so before. A file that is there
 * is replaced only when this is called again for it. A name without .png, .exr, .svg or .pdf gets .png,
 * but that of a picture of another kind is refused. */
void figure_form_save(struct window *window);
/** Draws what would be saved, small, some frames later. */
void figure_form_preview(struct window *window);
/** The preview, where all is as it was then; NULL = there is none. */
const struct texture *figure_form_previewed(const struct window *window);
/** Once in each frame, after it was drawn. */
void figure_form_step(struct window *window);
/** Puts the path of the newest figure on the clipboard, as text. */
void figure_form_copy(struct window *window);

enum { FIGURE_REASON = 512 };

/** The options of conus render that the window's sheet and background mean. */
void figure_of_window(struct figure_settings *out, const struct window *window);

/** Draws @p pane (PANE_3D, or a plane) with the look, the cone and the place that it has now, and writes it. In 3-D a
 * shape other than the pane's shows more or less to the left and right. False where that fails, and @p why says it. */
bool figure_write(const struct window *window, size_t pane, const struct figure_settings *settings, const char *path,
                  char why[FIGURE_REASON]);

#endif
