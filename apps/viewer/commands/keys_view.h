/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Keys that move what the panes look at, by the steps of a mouse. */
#ifndef CONUS_VIEWER_KEYS_VIEW_H
#define CONUS_VIEWER_KEYS_VIEW_H

#include "viewer/window/window.h"

/** What a key does; false where it is none of them. */
bool keys_view_press(struct window *window, const char *key);
/** The keys, as people write them, and what they do; NULL = no more. */
const char *keys_view_name(const char **meaning, size_t index);

#endif
