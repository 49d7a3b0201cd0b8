/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The command line of a sidecar, back as words. */
#ifndef CONUS_CLI_VERIFY_COMMAND_LINE_H
#define CONUS_CLI_VERIFY_COMMAND_LINE_H

#include <stdbool.h>
#include <stddef.h>

enum { COMMAND_WORDS = 4096 };

struct command_line {
    char *text;   /**< What the words point into. */
    char **words; /**< [count], and NULL behind them. */
    size_t count;
};

/** Cuts @p text into words, as arguments_text() writes them: bare, or in single quotes. Nothing else that a shell knows
 * is taken. Returns NULL, or why it is none of ours, a text that lasts; then @p out is empty. @p out is the caller's to
 * command_line_finish(). */
const char *command_line_parse(struct command_line *out, const char *text);
void command_line_finish(struct command_line *line);

#endif
