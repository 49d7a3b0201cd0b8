/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Answers again what a sidecar records: this program runs once more, in a new folder. The folder holds links to the
 * files that were found, or copies where the system has no links, and gets all outputs. */
#ifndef CONUS_CLI_VERIFY_REPLAY_H
#define CONUS_CLI_VERIFY_REPLAY_H

#include "cli/verify/find_file.h"
#include "options/options.h"

enum { REPLAY_WHY = 512 };

/** A replay under way. Zeroed, there is none. */
struct replay {
    const struct record *record;
    const struct found_file *found; /**< [record->input_count] */
    const struct command *command;
    const char *engine; /**< --engine in place of the recorded one; NULL = that. */
    struct arguments arguments;
    void *settings;
    char *folder;         /**< Made by replay_run(); replay_finish() removes it. */
    bool is_moved;        /**< An absolute path is no longer where it was: all of them are in that folder. */
    char why[REPLAY_WHY]; /**< The reason of a failure. */
    bool is_said;         /**< The command itself gave it, which knows what is in the files. */
};

/** Takes the recorded command line apart by @p commands, a list that ends with NULL: it must be of one of those that
 * answer questions. False, with out->why, where it is not. @p out is the caller's to replay_finish() in any case. */
bool replay_parse(struct replay *out, const struct command *const *commands);

/** The same, and it must be a question that can be asked again. False, with out->why, where it is not. @p out is the
 * caller's to replay_finish() in any case. */
bool replay_check(struct replay *out, const struct command *const *commands);

/** Answers. False, with replay->why, where there is no answer. */
bool replay_run(struct replay *replay);

void replay_finish(struct replay *replay);

struct stage {
    char *folder;  /**< In $TMPDIR or /tmp, "conus-NAME-" and six letters; nobody else can read it. */
    char *cwd;     /**< Where relative paths begin; deep enough for every "..". */
    bool is_moved; /**< An absolute path is no longer where it was: all of them are links. */
};

/** Makes its folder and nothing in it. False likewise. */
bool stage_begin(struct stage *out, const char *name);
/** Makes a link to @p target by the name @p path, or where the system has none a copy, and the folders before it.
 * False, after an error message, where that fails. */
bool stage_link(const struct stage *stage, const char *path, const char *target);

/** Makes it. False, after an error message, where that fails; @p out is the caller's to stage_finish() in any case, and
 * out->folder to stage_remove(). */
bool stage_make(struct stage *out, const struct record *record, const struct found_file *found);
void stage_finish(struct stage *stage);

/** The word @p given, whose paths are those that were recorded, with the paths in the stage. NULL without memory; the
 * caller frees it. */
char *stage_word(const struct stage *stage, const char *given);

/** Takes the stage's folder from the absolute paths in @p text, wherever they stand: stage_word()'s are as given. */
void stage_leave(char *text, const char *folder);

/** A new path for the output of @p option, with the name @p name. NULL where it cannot be made; the caller frees it. */
char *stage_output(const struct stage *stage, const char *option, const char *name);
/** The file that was written there, other than one in ".json" beside another. NULL if there is none, or no @p folder;
 * likewise. */
char *stage_find_output(const char *folder, const char *option);

/** Removes it and frees @p folder, which may be NULL. */
void stage_remove(char *folder);

#endif
