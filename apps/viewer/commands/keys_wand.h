/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Keys that move a tool that is moved as a wand. */
#ifndef CONUS_VIEWER_KEYS_WAND_H
#define CONUS_VIEWER_KEYS_WAND_H

#include "viewer/window/window.h"

/** What a key does; false where it is none of them, or no tool is a wand. */
bool keys_wand_press(struct window *window, const char *key);
/** One of them; NULL = no more. */
const char *keys_wand_name(size_t index);

#endif
