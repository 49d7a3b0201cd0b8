/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The keys of the window and what they do. */
#ifndef CONUS_VIEWER_KEYS_H
#define CONUS_VIEWER_KEYS_H

#include "viewer/window/window.h"

/** What a key does, for window->press. */
bool keys_press(struct window *window, const char *key);

/** A key and what it does, NULL where it is not listed; NULL = no more keys. */
const char *keys_name(const char **meaning, size_t index);

/** Draws the list of keys over the window. */
void keys_draw_help(struct window *window);

#endif
