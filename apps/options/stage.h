/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A new folder that only the user can read, in which files stand where somebody else's paths name them: by links, or by
 * copies where the system has no links. */
#ifndef CONUS_OPTIONS_STAGE_H
#define CONUS_OPTIONS_STAGE_H

#include <stdbool.h>

struct stage {
    char *folder; /**< In $TMPDIR or /tmp, "conus-NAME-" and six letters. */
    char *cwd;    /**< Where relative paths begin: in it, as deep as was asked for. */
    int levels;
};

/** Makes its folder and nothing in it. Relative paths may have fewer than @p levels "..", or none where it is 0. False,
 * after an error message, where that fails; @p out is the caller's to stage_end() in any case. */
bool stage_begin(struct stage *out, const char *name, int levels);

/** Makes a link to @p target, a whole path, by the name @p path, or where the system has none a copy, and the folders
 * before it. False, after an error message, where that fails. */
bool stage_link(const struct stage *stage, const char *path, const char *target);

/** The word @p given, whose paths are somebody else's, with the stage's folder before each whole one: "from=/a". NULL
 * without memory; the caller frees it. */
char *stage_word(const struct stage *stage, const char *given);

/** Takes the stage's folder from the whole paths in @p text, wherever they stand: stage_word()'s are as given. */
void stage_leave(char *text, const char *folder);

/** A new path, in a folder of its own in the stage, for the output of @p option with the name @p name. NULL where it
 * cannot be made; the caller frees it. */
char *stage_output(const struct stage *stage, const char *option, const char *name);
/** The file that was written there, other than one in ".json" beside another; NULL if there is none, likewise. */
char *stage_find_output(const struct stage *stage, const char *option);

/** Removes it, with all that is in it, unless @p stays. */
void stage_end(struct stage *stage, bool stays);

#endif
