/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The script's words of the second tool. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_SECOND_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_SECOND_H

#include "viewer/window/window.h"

/** What script_second() takes. */
extern const char script_second_arguments[];

/** Does what @p words, [count], say: "on", "aim X Y Z TX TY TZ", ... False where they are wrong, or it fails. */
bool script_second(struct window *window, const char *const *words, size_t count);

#endif
