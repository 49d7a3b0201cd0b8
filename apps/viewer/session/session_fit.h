/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A session of an atlas to which other files were added than now: its objects' numbers become those of now. */
#ifndef CONUS_VIEWER_SESSION_SESSION_FIT_H
#define CONUS_VIEWER_SESSION_SESSION_FIT_H

#include "viewer/window/window.h"

#include <jansson.h>

/** Changes a session's @p root, of which "opened" says what was added, so that it is of the first atlas of the window
 * as it is opened now. What was of an object that is not there any more is left out; so are grey values and colours of
 * another context. Unchanged where that is not said, of the root or of the window, and without memory. */
void session_fit(json_t *root, const struct window *window);
/** Puts the files that the window's session has, and that were not found, into @p root, which is to be saved in its
 * place, with all that is set for their objects, which get numbers after all others. False without memory. */
bool session_keep_lost(json_t *root, const struct window *window);

#endif
