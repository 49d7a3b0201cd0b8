/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Where the window was and how large, from one run to the next: conus/window.json in $XDG_STATE_HOME, else in
 * ~/.local/state. */
#ifndef CONUS_VIEWER_PLACE_H
#define CONUS_VIEWER_PLACE_H

#include <stdbool.h>

struct place {
    int width, height;
    bool known; /**< x and y hold. */
    int x, y;
};

/** Reads it into @p out, which stays as it is where there is none, or none that makes sense. */
void place_load(struct place *out);
/** Writes it; where that cannot be done the next window is as large as the first one. */
void place_save(const struct place *place);

#endif
