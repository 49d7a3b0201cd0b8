/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Takes back and does again what a user has changed: all that a session keeps, but for where the panes look, and for
 * what moves by itself, such as a cone that follows the mouse or a tracker. */
#ifndef CONUS_VIEWER_SESSION_UNDO_H
#define CONUS_VIEWER_SESSION_UNDO_H

#include "viewer/window/window.h"

/** Notes the state if it changed. To be called where changes are whole: not while a slider is dragged. */
void undo_note(struct window *window);
/** The state is as it was noted last, though the atlas is not: that is no change to be taken back. */
void undo_renew(struct window *window);
/** Goes a change back (-1) or forth (1), and says so. Where the atlases are to be opened again for it, only once they
 * are (window->files.requested). */
void undo_step(struct window *window, int by);
/** They are: goes there. */
void undo_go_on(struct window *window, int by);

#endif
