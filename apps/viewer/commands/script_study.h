/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Commands of scripts about studies. */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_STUDY_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_STUDY_H

#include "viewer/window/window.h"

/** Both get their @p count arguments, as many as the table of commands allows; false where they are wrong, or cannot
 * be, which stderr says. */
bool script_sweep(struct viewer *viewer, char *const *arguments, size_t count);
bool script_jitter(struct viewer *viewer, char *const *arguments, size_t count);

/** Writes the study as conus sweep would; false where there is none or that fails, which stderr says. */
bool script_study(struct viewer *viewer, const char *path);

#endif
