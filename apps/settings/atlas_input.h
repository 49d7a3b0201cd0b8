/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Loads the atlas, its pathways, streamlines and context as the options say. */
#ifndef CONUS_SETTINGS_ATLAS_INPUT_H
#define CONUS_SETTINGS_ATLAS_INPUT_H

#include "conus/own.h"
#include "settings/settings.h"

/** An atlas, or an image, as it was given. */
struct atlas_name {
    conus_catalogue *catalogue;   /**< It is one of its entries; NULL if there was no need to look. */
    const conus_installed *atlas; /**< NULL: what was given is a path. */
    const char *path;             /**< For conus_atlas_load(). */
    char *owned;                  /**< That path with a ",template=" behind it; NULL without one. */
};

/** Finds out what @p text means: a file or folder of that path, or else the installed atlas of that name. @p text must
 * outlive @p out. Returns the exit code and prints an error unless it is 0; @p out is the caller's to finish in every
 * case. */
int atlas_name_find(struct atlas_name *out, const char *text);
/** The same of a context: a surface is always a path. */
int context_name_find(struct atlas_name *out, const char *text);
void atlas_name_finish(struct atlas_name *name);

/** The labels to load it with: those of --labels, @p given, or else those of the installed atlas; NULL = none. */
const char *atlas_name_labels(const struct atlas_name *name, const char *given);

/** Loads the atlas, a path or the name of an installed one, and adds its pathways and streamlines. Returns the exit
 * code and prints an error unless it is 0, or the settings' progress cancelled. */
int atlas_input_load(conus_atlas **out, const char *path, const struct atlas_settings *settings);

/** Whether @p why is the library's message about an image that is no atlas but may be drawn around one. */
bool atlas_input_is_image(const char *why);

/** Sets the context, unless @p path is NULL; @p blocks 0 = it does not block. Gives the exit code likewise. */
int atlas_input_load_context(conus_atlas *atlas, const char *path, double blocks,
                             const struct atlas_settings *settings);

/** Sets each file as a context: a volume replaces the one before, surfaces add up. Gives the exit code likewise. */
int context_choice_load(conus_atlas *atlas, const struct context_choice *choice, const struct atlas_settings *settings);

/** Whether one of the files is no surface. */
bool context_choice_has_volume(const struct context_choice *choice);

#endif
