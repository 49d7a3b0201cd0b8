/* SPDX-License-Identifier: BSD-3-Clause */
/** @file ATLAS on a command line: a path, or the name of an installed atlas. */
#ifndef CONUS_SETTINGS_ATLAS_NAME_H
#define CONUS_SETTINGS_ATLAS_NAME_H

#include "settings/settings.h"

struct atlas_name {
    conus_catalogue *catalogue;   /**< What the atlas belongs to; NULL if there was no need to look. */
    const conus_installed *atlas; /**< NULL: what was given is a path. */
    const char *path;             /**< For conus_atlas_load(). */
};

/** Finds out what @p text, which must outlive @p out, means: what is there under that path, or else the installed atlas
 * of that name. Returns the exit code and prints an error unless it is 0; @p out is the caller's to finish in every
 * case. */
int atlas_name_find(struct atlas_name *out, const char *text);
void atlas_name_finish(struct atlas_name *name);

/** The labels to load it with: those of --labels, @p given, or else those of the installed atlas; NULL = none. */
const char *atlas_name_labels(const struct atlas_name *name, const char *given);

#endif
