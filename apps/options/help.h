/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The texts of --help. */
#ifndef CONUS_OPTIONS_HELP_H
#define CONUS_OPTIONS_HELP_H

#include "options/options.h"

/** --help of one command. */
void help_command(FILE *out, const struct command *command);
/** -h of one command: what it does, its commonest options and two examples, on at most 20 lines. */
void help_brief(FILE *out, const struct command *command);
/** One line that shows a command's form: "conus query ATLAS [options]". */
void help_usage(FILE *out, const struct command *command);

/** What exit code @p code means, in a few words; NULL past the last. */
const char *help_exit_code(size_t code);

#endif
