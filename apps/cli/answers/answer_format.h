/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The format of an answer, the file it goes to, and the sidecar beside that file. */
#ifndef CONUS_CLI_ANSWERS_ANSWER_FORMAT_H
#define CONUS_CLI_ANSWERS_ANSWER_FORMAT_H

#include "settings/settings.h"

struct answer_settings {
    size_t format; /* conus_format */
    const char *output;
};

extern const struct option format_options[];        /**< answer_settings: --format */
extern const struct option query_format_options[];  /**< The same, with the formats of other programs. */
extern const struct option answer_output_options[]; /**< answer_settings: --output */

/** The format of --format if that was given, else the one of the ending of --output; a table for stdout, a device or a
 * pipe, which have no ending. False, after an error message, for a file whose ending says nothing. */
bool answer_format(conus_format *out, const struct arguments *arguments, const struct answer_settings *settings);

/** "answer.tsv" or "answer.csv" has its sidecar in "answer.json": sets *out, the caller's to free(), or NULL where
 * there is none to write. False without memory. */
bool answer_sidecar(char **out, conus_format format, const char *output);

/** Writes the report's sidecar to @p path, unless that is NULL. Returns the exit code and prints an error unless it is
 * 0. */
int answer_write_sidecar(conus_report *report, const char *path);
/** Writes the report's text, likewise; it comes last. */
int answer_write(conus_report *report, const char *path);

#endif
