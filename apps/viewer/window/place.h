/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Where the window was and how large, from one run to the next: conus/window.json in $XDG_STATE_HOME, else in
 * ~/.local/state. */
#ifndef CONUS_VIEWER_WINDOW_PLACE_H
#define CONUS_VIEWER_WINDOW_PLACE_H

#include "viewer/window/layout.h"

#include <stdbool.h>
#include <stddef.h>

struct place {
    int width, height;
    bool known; /**< x and y hold. */
    int x, y;
    struct layout layout;
    double zoom; /**< Zoom of texts and panels by the user: times the screen's scale; 0 = 1. */
};

enum { PLACE_LEAST_ZOOM = 50, PLACE_MOST_ZOOM = 400 /* per cent */ };

/** Makes it no larger than @p area, x, y, width and height of what a screen leaves free, and moves it there. */
void place_fit(struct place *place, const int area[4]);
/** How large texts shall be on a screen that is @p millimetres wide with so many @p pixels: @p content, as the desktop
 * says, where that is not 1; else by the density in steps of a quarter, from 1 at 96 pixels per inch, to 3. Densities
 * that no screen has, and widths that none says, count as 96. */
float place_scale(float content, int pixels, int millimetres);

/** Reads what was written; false, and @p out stays as it is, where that makes no sense. */
bool place_parse(struct place *out, const char *text, size_t size);
/** Reads the place into @p out, which stays as it is where no valid place is stored. */
void place_load(struct place *out);
/** Writes it; where that cannot be done the next window is as large as the first one. */
void place_save(const struct place *place);

#endif
