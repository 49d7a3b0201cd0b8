/* SPDX-License-Identifier: BSD-3-Clause */
/** @file ATLAS and those of --atlas: several atlases that are asked the same, each with a name for its answers. */
#ifndef CONUS_SETTINGS_ATLASES_H
#define CONUS_SETTINGS_ATLASES_H

#include "conus/atlas.h"
#include "settings/atlas_input.h"
#include "settings/settings.h"
#include "settings/tract_shelf.h"

struct named_atlas {
    conus_atlas *atlas;
    const char *given; /**< The path or name on the command line: borrowed. */
    char *name; /**< Its name in the column `atlas`: the catalogue's name, or the file's without folder and ending. No
                   two are equal. UTF-8, one line. NULL where there is one atlas only. */
};

struct atlases {
    struct named_atlas *items; /**< [count] ATLAS, then those of --atlas. */
    size_t count;
    double opening_ms;        /**< How long loading took. */
    bool shares_streamlines;  /**< Every atlas has the bundles of --streamlines; they are in memory once. */
    struct tract_shelf shelf; /**< If so: these. */
};

enum { ATLAS_PREFIX_SIZE = 256 };

/** Writes to @p out the beginning of a message about one of several atlases, "NAME: "; "" if there is only one. */
const char *atlases_prefix(char out[ATLAS_PREFIX_SIZE], const struct named_atlas *atlas);

/** Loads @p path and those of --atlas, each with its @p context (NULL = none). Returns the exit code and prints an
 * error unless it is 0. @p out, which the caller zeroes but for shares_streamlines, is the caller's to atlases_finish()
 * in any case. */
int atlases_load(struct atlases *out, const char *path, const struct atlas_settings *settings,
                 const struct context_settings *context);
/** Only finds their names; each atlas is then to be loaded, or put there. Gives the exit code likewise. */
int atlases_name(struct atlases *out, const char *path, const struct atlas_settings *settings);
/** Loads those that are not there yet, each with its @p context (NULL = none). --labels, --pathway, --only and --hide
 * apply to the first atlas only; so does --streamlines, unless shared. Gives the exit code likewise. */
int atlases_load_all(struct atlases *atlases, const struct atlas_settings *settings,
                     const struct context_settings *context);
void atlases_finish(struct atlases *atlases);

/** Whether a sidecar can hold the names of all files that were read. Returns the exit code and prints an error unless
 * it is 0. */
int atlases_check_names(const struct atlases *atlases);

/** Whether the headers of two volumes, NULL = none, name different spaces. */
bool spaces_differ(const conus_volume_info *a, const conus_volume_info *b);

/** Says on stderr, unless --quiet, which atlas is hardly in the space of the first: where both name their spaces, and
 * these differ, or where no voxel and no triangle of one is in the box around the other. */
void atlases_say_spaces(const struct atlases *atlases, const struct common_settings *settings);

#endif
