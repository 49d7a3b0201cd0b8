/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Completions for bash, fish and zsh: commands, options, choices, files. */
#ifndef CONUS_PAGES_COMPLETION_H
#define CONUS_PAGES_COMPLETION_H

#include "pages/pages.h"

void completion_bash(FILE *out, const struct program *program);
void completion_fish(FILE *out, const struct program *program);
void completion_zsh(FILE *out, const struct program *program);

/** What the shell offers for the value of an option. */
enum completion_value {
    COMPLETION_NONE,    /**< The option has no value. */
    COMPLETION_CHOICES, /**< option_choice() lists them. */
    COMPLETION_FILE,
    COMPLETION_FOLDER,
    COMPLETION_ATLAS, /**< A file, or a name as of completion_takes_atlas(). */
    COMPLETION_ANY,   /**< A value that only the user knows: a number, a name. */
};
enum completion_value completion_value(const struct option *option);

/** Whether the operand is an atlas: a file, or a name that `conus atlases --format names` lists. */
bool completion_takes_atlas(const struct command *command);

/** Option @p index of all groups of a command; NULL past the last. */
const struct option *completion_option(const struct command *command, size_t index);

/** Writes @p text within single quotes of sh, with a backslash before each character of @p special. */
void completion_quote(FILE *out, const char *text, const char *special);

#endif
