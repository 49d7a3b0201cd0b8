/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The notes about an atlas, on stderr. */
#ifndef CONUS_SETTINGS_ATLAS_NOTES_H
#define CONUS_SETTINGS_ATLAS_NOTES_H

#include "settings/settings.h"

/** Says the atlas's notes on stderr, unless --quiet. */
void settings_say_notes(const conus_atlas *atlas, const struct common_settings *settings);

#endif
