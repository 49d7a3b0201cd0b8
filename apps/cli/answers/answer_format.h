/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options for the format of an answer, the file it goes to, and the sidecar beside that file. */
#ifndef CONUS_CLI_ANSWERS_ANSWER_FORMAT_H
#define CONUS_CLI_ANSWERS_ANSWER_FORMAT_H

#include "conus/report.h"
#include "options/output.h"
#include "options/outputs.h"
#include "options/provenance.h"
#include "settings/atlases.h"
#include "settings/settings.h"

struct answer_settings {
    size_t format; /* conus_format */
    const char *output;
    const char *sidecar; /* NULL = beside the output */
    bool force;
};

extern const struct option format_options[];        /**< answer_settings: --format */
extern const struct option query_format_options[];  /**< The same, with the formats of other programs. */
extern const struct option answer_output_options[]; /**< answer_settings: --output, --sidecar, --force */

/** The format of --format if that was given, else the one of the ending of --output; a table for stdout, a device or a
 * pipe, which have no ending. False, after an error message, for a file whose ending says nothing. */
bool answer_format(conus_format *out, const struct arguments *arguments, const struct answer_settings *settings);

/** Finds the path of the sidecar: that of --sidecar; else that of --output with ".json" in place of ".tsv" or ".csv",
 * or behind it. *out is the caller's to free(). It is NULL where no sidecar is written: a report in JSON says
 * everything itself, and --sidecar may be none. Returns the exit code and prints an error unless it is 0. */
int answer_sidecar(char **out, conus_format format, const struct answer_settings *settings);

/** Whether nothing is at the @p path, NULL or where the sidecar of a file would be: with --sidecar none, what is there
 * would seem to describe that file. Likewise. */
int answer_check_no_sidecar(const char *path);

/** Checks the names of the atlases' files and the words of the command line, where they are recorded: in a sidecar or
 * a file in JSON. Likewise. */
int answer_check_names(conus_format format, const struct outputs *outputs, const struct arguments *arguments,
                       const struct atlases *atlases);

#endif
