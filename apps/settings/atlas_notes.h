/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The notes about an atlas, on stderr. */
#ifndef CONUS_SETTINGS_ATLAS_NOTES_H
#define CONUS_SETTINGS_ATLAS_NOTES_H

#include "settings/atlases.h"

/** Says the atlas's notes on stderr, unless --quiet. */
void settings_say_notes(const conus_atlas *atlas, const struct common_settings *settings);
/** The same of several; each note begins with the atlas's name. */
void atlases_say_notes(const struct atlases *atlases, const struct common_settings *settings);

/** Says on stderr, unless --quiet, where all layers are asked for, how many surfaces are not closed and what that means
 * for them. */
void atlases_say_open(const struct atlases *atlases, const struct engine_settings *engine,
                      const struct common_settings *settings);

#endif
