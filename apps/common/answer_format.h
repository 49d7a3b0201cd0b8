/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What an answer is written in, what is written beside it, and where to. */
#ifndef CONUS_COMMON_ANSWER_FORMAT_H
#define CONUS_COMMON_ANSWER_FORMAT_H

#include "common/settings.h"

struct answer_settings {
    size_t format; /* conus_format */
    const char *output;
};

extern const struct option answer_options[];       /**< answer_settings: --format, --output */
extern const struct option query_answer_options[]; /**< The same, with the formats of other programs. */

/** The format of --format if that was given, else what the ending of --output says, a table for what has none because
 * it is no file. False, after an error message, for a file whose ending says nothing. */
bool answer_format(conus_format *out, const struct arguments *arguments, const struct answer_settings *settings);

/** "answer.tsv" or "answer.csv" has its sidecar in "answer.json": sets *out, the caller's to free(), or NULL where
 * there is none to write. False without memory. */
bool answer_sidecar(char **out, conus_format format, const char *output);

/** Whether neither the answer in @p output nor its @p sidecar would overwrite what is read, the atlas's files or one of
 * @p inputs (as of settings_input()); prints an error if so. */
bool answer_check_files(const conus_atlas *atlas, const struct input *inputs, const char *output, const char *sidecar);

/** Writes the report's sidecar to @p path, unless that is NULL. Returns the exit code and prints an error unless it is
 * 0.
 */
int answer_write_sidecar(conus_report *report, const char *path);
/** Writes the report's text, likewise; it comes last. */
int answer_write(conus_report *report, const char *path);

#endif
