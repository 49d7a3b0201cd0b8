/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The man pages, shell completions and JSON of a program, from the tables that its parser and --help use. The build
 * runs each program with --write-pages and installs what it writes. */
#ifndef CONUS_PAGES_PAGES_H
#define CONUS_PAGES_PAGES_H

#include "options/options.h"

#include <jansson.h>

/** A program and its commands. */
struct program {
    const char *name;    /**< "conus" */
    const char *summary; /**< One line, no final period. */
    const char *description;
    const struct command *const *commands; /**< Ends with NULL. One is explained on the program's own page; several have
                                                a page each, NAME-COMMAND, but those of other programs. */
    bool unnamed;                          /**< The one command is not named on the command line. */
};

/** Whether the command line is PROGRAM help --json, which writes the tables as JSON (docs/commands.md), or PROGRAM
 * --write-pages FOLDER. Then writes the files, makes the folder where it is
 * missing, prints an error for what fails, and sets @p code. Man pages are NAME.1 and NAME-COMMAND.1, completions
 * NAME.bash, NAME.fish and _NAME. */
bool pages_answer(int *code, const struct program *program, int count, char **words);

/** The commands and options as JSON. Returns the exit code and prints an error unless it is 0. */
int pages_put_rows(FILE *out, const struct program *program);
/** One command with its options, in their order: a new reference, NULL without memory. */
json_t *pages_command(const struct command *command);

void completion_bash(FILE *out, const struct program *program);
void completion_fish(FILE *out, const struct program *program);
void completion_zsh(FILE *out, const struct program *program);

/** The page of a program with several commands: what it is, its commands, its exit codes. */
void man_page_program(FILE *out, const struct program *program);

/** The page of one command; of a program with only this one, the program's page. False without memory. */
bool man_page_command(FILE *out, const struct program *program, const struct command *command);

#endif
