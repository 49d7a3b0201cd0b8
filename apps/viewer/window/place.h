/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Where the window was and how large, from one run to the next: conus/window.json in $XDG_STATE_HOME, else in
 * ~/.local/state. */
#ifndef CONUS_VIEWER_WINDOW_PLACE_H
#define CONUS_VIEWER_WINDOW_PLACE_H

#include <stdbool.h>
#include <stddef.h>

struct place {
    int width, height;
    bool known; /**< x and y hold. */
    int x, y;
};

/** Reads what was written; false, and @p out stays as it is, where that makes no sense. */
bool place_parse(struct place *out, const char *text, size_t size);
/** Reads it into @p out, which stays as it is where there is none, or none that makes sense. */
void place_load(struct place *out);
/** Writes it; where that cannot be done the next window is as large as the first one. */
void place_save(const struct place *place);

#endif
