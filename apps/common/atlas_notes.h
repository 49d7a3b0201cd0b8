/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The notes about an atlas, on stderr. */
#ifndef CONUS_COMMON_ATLAS_NOTES_H
#define CONUS_COMMON_ATLAS_NOTES_H

#include "common/settings.h"

/** Says the atlas's notes on stderr, unless --quiet. */
void settings_say_notes(const conus_atlas *atlas, const struct common_settings *settings);

#endif
