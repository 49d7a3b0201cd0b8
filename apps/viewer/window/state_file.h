/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Small files that the window keeps from one run to the next, in $XDG_STATE_HOME/conus, else in
 * ~/.local/state/conus. */
#ifndef CONUS_VIEWER_WINDOW_STATE_FILE_H
#define CONUS_VIEWER_WINDOW_STATE_FILE_H

#include "base/system/system.h"

#include <stdbool.h>
#include <stddef.h>

/** The path of @p name in a folder that is made; false where there is no home, or it is too long. */
bool state_file_path(char path[SYSTEM_PATH], const char *name);
/** The bytes of the file @p name, to be freed; NULL where there is none, or it has more than @p limit. */
char *state_file_read(size_t *size, const char *name, size_t limit);
/** Writes it, whole or not at all; where that cannot be done the next run finds what the one before left. */
void state_file_write(const char *name, const char *text, size_t size);

/** The path that people type: ~ is the home folder. False where it is empty, or too long. */
bool typed_path(char path[SYSTEM_PATH], const char *text);

#endif
