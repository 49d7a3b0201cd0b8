/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Notes about atlases, and about where cones lie and point. */
#ifndef CONUS_SETTINGS_NOTES_H
#define CONUS_SETTINGS_NOTES_H

#include "conus/selection.h"
#include "conus/space.h"
#include "settings/atlases.h"
#include "settings/settings.h"

/** How poses aim at an atlas. */
struct aimed {
    conus_pose_findings found;
    conus_selector *selector;
    const conus_atlas *atlas;
    const char *name;         /**< NULL where there is one only. */
    const conus_frame *frame; /**< The space of the positions as they were given. */
    bool is_of_probes;        /**< `found.away` are probes that pass nothing. */
    double radius;            /**< Of the balls around points, mm; 0 = they have none. */
};

/** Prints notes about odd poses on stderr, a line for each kind, unless --quiet; and what one such pose would hit in
 * another space or unit, if it would hit anything. A note about all @p count atlases is printed once; any other one
 * ends with the names of its atlases. @p file has the poses, NULL = there is one pose. */
void aim_notes_say(const struct aimed *aimed, size_t count, const char *file, const struct common_settings *settings);

/** Says the atlas's notes on stderr, unless --quiet. */
void atlas_notes_say(const conus_atlas *atlas, const struct common_settings *settings);
/** The same of several; each note begins with the atlas's name. On a terminal also, if opening them took more than a
 * second, that there are packs. */
void atlases_say_notes(const struct atlases *atlases, const struct common_settings *settings);

/** Says on stderr, unless --quiet, where all layers are asked for, how many surfaces are not closed and what that means
 * for them. */
void atlases_say_open(const struct atlases *atlases, const struct engine_settings *engine,
                      const struct common_settings *settings);

#endif
