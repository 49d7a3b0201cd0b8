/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Keys that change how the atlas looks. */
#ifndef CONUS_VIEWER_KEYS_LOOK_H
#define CONUS_VIEWER_KEYS_LOOK_H

#include "viewer/window/window.h"

void look_brighter(struct window *window);
void look_darker(struct window *window);
void look_more_contrast(struct window *window);
void look_less_contrast(struct window *window);
void look_reset_grey(struct window *window);
void look_more_opaque(struct window *window);
void look_less_opaque(struct window *window);
void look_next_streamlines(struct window *window);
void look_next_backdrop(struct window *window);

#endif
