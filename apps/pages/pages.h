/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The tables of a program's options, which its parser and --help use, as JSON. scripts/pages makes man pages and
 * completions of it, scripts/descriptors forms, scripts/option-lists lists of the documents. */
#ifndef CONUS_PAGES_PAGES_H
#define CONUS_PAGES_PAGES_H

#include "options/options.h"

#include <jansson.h>

/** A program and its commands. */
struct program {
    const char *name;    /**< "conus" */
    const char *summary; /**< One line, no final period. */
    const char *description;
    const struct command *const *commands; /**< Ends with NULL. One alone is not named on the command line. */
};

/** Whether the command line is PROGRAM help --json. Then writes the tables (docs/commands.md), prints an error for what
 * fails, and sets @p code. */
bool pages_answer(int *code, const struct program *program, int count, char **words);

/** One command with its options, in their order: a new reference, NULL without memory. */
json_t *pages_command(const struct command *command);

#endif
