/* SPDX-License-Identifier: BSD-3-Clause */
/** @file ATLAS and those of --atlas: several atlases that are asked the same, each with a name for its answers. */
#ifndef CONUS_SETTINGS_ATLASES_H
#define CONUS_SETTINGS_ATLASES_H

#include "settings/settings.h"

struct named_atlas {
    conus_atlas *atlas;
    char *name; /**< What the column `atlas` says: the catalogue's name, or the file's without folder and ending. No two
                     are equal. UTF-8, one line. NULL where there is one atlas only. */
};

struct atlases {
    struct named_atlas *items; /**< [count] ATLAS, then those of --atlas. */
    size_t count;
};

/** Finds out what the atlases are called: @p path and then those of --atlas. Returns the exit code and prints an error
 * unless it is 0. @p out, which the caller zeroes, is the caller's to atlases_finish() in any case. */
int atlases_name(struct atlases *out, const char *path, const struct atlas_settings *settings);

/** Loads all of them, but those that are there already; gives them names, unless they have them. --labels, --pathway,
 * --only and --hide are only of the first. Gives the exit code likewise. */
int atlases_load(struct atlases *out, const char *path, const struct atlas_settings *settings);
void atlases_finish(struct atlases *atlases);

/** Says on stderr, unless --quiet, which atlas is hardly in the space of the first: where both name their spaces, and
 * these differ, or where no voxel and no triangle of one is in the box around the other. */
void atlases_say_spaces(const struct atlases *atlases, const struct common_settings *settings);

#endif
