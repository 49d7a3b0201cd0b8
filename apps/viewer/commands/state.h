/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the newest frame shows, as numbers of answers, for scripts. */
#ifndef CONUS_VIEWER_COMMANDS_STATE_H
#define CONUS_VIEWER_COMMANDS_STATE_H

#include "viewer/window/window.h"

/** Writes the viewer's numbers (`is`), and those of each place that the frame has: `list`, `labels`, `status`,
 * `picture`; `colours` is the sum of the answer, and `cuts` are those of the answers that they were drawn for. False:
 * it cannot be written. */
bool state_write(const struct window *window, const char *path);

#endif
