/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The window's loop. It sleeps until something happens: an event, a picture of the painter's, a pose of the tracker's,
 * the next row of a replay. Frames are drawn only when they show something else than the one before. */
#ifndef CONUS_VIEWER_LOOP_H
#define CONUS_VIEWER_LOOP_H

#include "viewer/commands/commands.h"

/** Shows @p window until it is closed or @p script (NULL = none) ends, which may set the exit code: false; or until
 * another atlas is wanted: true. */
bool loop_run(struct window *window, struct script *script, int *code);

/** Wakes the loop, from any thread. Costs nothing while it is awake. */
void loop_wake(void);

#endif
