/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The window's title: what a list of windows and a screen reader say of it. */
#ifndef CONUS_VIEWER_WINDOW_TITLE_H
#define CONUS_VIEWER_WINDOW_TITLE_H

#include "viewer/window/window.h"

/** "conus"; with an atlas "conus - aal.nii.gz [session.json] - Hippocampus_L (held)": its file, the session's if there
 * is one, and the best hit in the drawn atlas (hit, or held) or else the chosen area (chosen). */
void title_write(char out[TITLE_SIZE], const struct window *window);
/** Gives the window its title, where that is another one than before. */
void title_update(struct window *window);

#endif
