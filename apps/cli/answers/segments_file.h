/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The file of --segments: what the axes of a query's poses pass, in a report of its own for each atlas. */
#ifndef CONUS_CLI_ANSWERS_SEGMENTS_FILE_H
#define CONUS_CLI_ANSWERS_SEGMENTS_FILE_H

#include "common/provenance.h"
#include "settings/settings.h"

struct segments_file {
    const char *path; /**< NULL = none. */
    conus_format format;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    conus_report **reports; /**< [count] That of the first atlas has the rows of all. */
    size_t count;
};

/* Those that return an int give the exit code and print an error unless it is 0. With no path they do nothing. */

/** Finds format and sidecar: the format by the ending of @p path, or @p format where that is no file. @p out is the
 * caller's to segments_file_finish() in any case. */
int segments_file_init(struct segments_file *out, const char *path, conus_format format);
void segments_file_finish(struct segments_file *file);

/** Makes the report of the next atlas. @p options has space, command and the atlas's name. */
conus_status segments_file_report(struct segments_file *file, const conus_selector *selector,
                                  const conus_report_options *options);

/** Adds what the axis of a pose passes in atlas @p index. */
int segments_file_add(struct segments_file *file, size_t index, const char *id, conus_selector *selector,
                      const conus_pose *pose);
/** Adds, for all atlases, why a pose has none. */
int segments_file_refuse(struct segments_file *file, const char *id, size_t line, const char *why);

/** Writes the sidecar and then the rows. */
int segments_file_write(const struct segments_file *file, const struct provenance *provenance);

#endif
