/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A folder in which an answer is made again. Relative paths that were recorded are links there to the files that were
 * found; so are absolute ones where one of them moved. Outputs have a folder each. */
#ifndef CONUS_CLI_VERIFY_STAGE_H
#define CONUS_CLI_VERIFY_STAGE_H

#include "cli/verify/find_file.h"

struct stage {
    char *folder;   /**< In $TMPDIR or /tmp; nobody else can read it. */
    char *cwd;      /**< Where relative paths begin; deep enough for every "..". */
    char *messages; /**< Path of a file for what is said. */
    bool is_moved;  /**< An absolute path is no longer where it was: all of them are links. */
};

/** Makes it. False, after an error message, where that fails; @p out is the caller's to stage_finish() in any case, and
 * out->folder to stage_remove(). */
bool stage_make(struct stage *out, const struct record *record, const struct found_file *found);
void stage_finish(struct stage *stage);

/** What stands for the word @p given, whose paths are those that were recorded. NULL without memory; the caller frees
 * it. */
char *stage_word(const struct stage *stage, const char *given);

/** A new path for the output of @p option, with the name @p name. NULL where it cannot be made; the caller frees it. */
char *stage_output(const struct stage *stage, const char *option, const char *name);
/** The file that was written there, other than one in ".json" beside another. NULL if there is none; likewise. */
char *stage_find_output(const char *folder, const char *option);

/** Removes it and frees @p folder, which may be NULL. */
void stage_remove(char *folder);

#endif
