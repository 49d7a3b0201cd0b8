/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Loads the atlas, its pathways, streamlines and context as the options say, and keeps outputs off their files.
 */
#ifndef CONUS_SETTINGS_ATLAS_INPUT_H
#define CONUS_SETTINGS_ATLAS_INPUT_H

#include "conus/atlas.h"
#include "conus/catalogue.h"
#include "settings/settings.h"

struct atlas_name {
    conus_catalogue *catalogue;   /**< The atlas is one of its entries; NULL if there was no need to look. */
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

/** Loads the atlas, a path or the name of an installed one, and adds its pathways and streamlines. Returns the exit
 * code and prints an error unless it is 0, or the settings' progress cancelled. */
int atlas_input_load(conus_atlas **out, const char *path, const struct atlas_settings *settings);

/** Whether @p why is the library's word for what is no atlas, but can be around one. */
bool atlas_input_is_image(const char *why);

/** Sets the context, unless @p path is NULL; @p blocks 0 = it does not block. Gives the exit code likewise. */
int atlas_input_load_context(conus_atlas *atlas, const char *path, double blocks,
                             const struct atlas_settings *settings);

/** Sets each of the files as what is around the areas: a volume in the place of another one, surfaces beside each
 * other. Gives the exit code likewise. */
int context_choice_load(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings);

/** Whether one of the files is no surface. */
bool context_choice_has_volume(const struct context_choice *choice);

/** A file that the command line names. */
struct input {
    const char *what; /**< "the atlas"; NULL ends a list. */
    const char *path; /**< NULL = not given. */
};

/** Names the file @p path, "the label table", if it is one of @p inputs or a file that @p atlas was read from, so that
 * no output overwrites it. NULL if it is none of them. */
const char *atlas_input_find(const conus_atlas *atlas, const struct input *inputs, const char *path);

#endif
