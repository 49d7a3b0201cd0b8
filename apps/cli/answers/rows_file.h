/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of rows beside the answers of a query, in a report of its own for each atlas: --segments, --endpoints.
 */
#ifndef CONUS_CLI_ANSWERS_ROWS_FILE_H
#define CONUS_CLI_ANSWERS_ROWS_FILE_H

#include "options/provenance.h"
#include "settings/settings.h"

struct rows_file {
    const char *option; /**< "segments" */
    conus_rows rows;
    const char *path; /**< NULL = none. */
    conus_format format;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    conus_report **reports; /**< [count] That of the first atlas has the rows of all. */
    size_t count;
};

/* Those that return an int give the exit code and print an error unless it is 0. With no path they do nothing. */

/** Finds format and sidecar of the file @p path of --@p option: the format by the ending, or @p format where that is no
 * file. @p out is the caller's to rows_file_finish() in any case. */
int rows_file_init(struct rows_file *out, const char *option, conus_rows rows, const char *path, conus_format format);
void rows_file_finish(struct rows_file *file);

/** Makes the report of the next atlas. @p options has space, command and the atlas's name. */
conus_status rows_file_report(struct rows_file *file, const conus_selector *selector,
                              const conus_report_options *options);

/** Adds, for all atlases, why a pose has none. */
int rows_file_refuse(struct rows_file *file, const char *id, size_t line, const char *why);

/** Writes the sidecar and then the rows. */
int rows_file_write(const struct rows_file *file, const struct provenance *provenance);

#endif
