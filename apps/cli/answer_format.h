/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What an answer is written in, and what is written beside it. */
#ifndef CONUS_CLI_ANSWER_FORMAT_H
#define CONUS_CLI_ANSWER_FORMAT_H

#include "cli/options.h"

#include <conus/conus.h>

/** Names of conus_format, for an option's choices. */
extern const char *const answer_formats[];

/** The format of --format if that was given, else what the ending of @p output says, else a table. */
conus_format answer_format(const struct arguments *arguments, size_t format, const char *output);

/** "answer.tsv" has its sidecar in "answer.json": sets *out, the caller's to free(), or NULL where there is none to
 * write. False without memory. */
bool answer_sidecar(char **out, conus_format format, const char *output);

#endif
