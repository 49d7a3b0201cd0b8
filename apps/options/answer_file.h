/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The files of an answer: its rows, and the sidecar that says what they were made from. */
#ifndef CONUS_OPTIONS_ANSWER_FILE_H
#define CONUS_OPTIONS_ANSWER_FILE_H

#include "conus/report.h"
#include "options/provenance.h"

/** Writes the report's sidecar to @p sidecar, unless that is NULL, and then its text to @p path. @p provenance has what
 * was read besides the atlas, and the other outputs, which are there already. Returns the exit code and prints an error
 * unless it is 0. */
int answer_write(conus_report *report, const char *path, const char *sidecar, const struct provenance *provenance);
/** Writes a report in JSON, which is its own sidecar, whose rows come last. */
int answer_write_json(const char *path, const struct provenance *provenance, const char *text, size_t size);
/** Writes only the sidecar of an answer whose text, @p size bytes, is known; NULL = it went to standard output. */
int answer_write_sidecar(conus_report *report, const char *path, const char *sidecar,
                         const struct provenance *provenance, const char *text, size_t size);

#endif
