/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The option --atlas-transform. */
#ifndef CONUS_SETTINGS_TRANSFORM_OPTION_H
#define CONUS_SETTINGS_TRANSFORM_OPTION_H

#include "settings/settings.h"

/** Moves @p atlas by the transforms, of which points go through the first one first. A field and what it
 * resamples may take @p max_memory, 0 = the default. Returns the exit code and prints an error unless it is 0. */
int transform_options_apply(conus_atlas *atlas, const struct option_list *texts, uint64_t max_memory);

#endif
