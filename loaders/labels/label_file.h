/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A label table from a file. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FILE_H
#define CONUS_LOADERS_LABELS_LABEL_FILE_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** Takes @p text apart at ",label=COLUMN" and ",name=COLUMN": gives the path; @p columns lie in @p text, empty where
 * none is given. CONUS_ERROR_ARGUMENT. */
const char *label_path_split(struct job *job, struct text columns[2], const char *text);

/** Reads the label table @p path, as label_path_split() takes it apart, into the empty @p out (and, for a table without
 * colours, X.lut beside it). *format is its name in words, static. @p use may be NULL. The job's files get what was
 * read. Outputs are untouched on failure. */
void label_file_read(struct job *job, struct label_table *out, const char **format, const char *path,
                     const struct label_use *use);

/** Bytes that a file may have so that its table takes no more than the job's max_memory. */
uint64_t label_file_limit(const struct job *job);

/** The bytes of a file, at most label_file_limit(). */
struct bytes label_file_bytes(struct job *job, const char *path);

bool label_table_has_colours(const struct label_table *table);

/** Colours @p table from the .lut @p path, which the job's files get; false if it has no colours alone (MRIcron's,
 * FSLeyes's without names) or is not there. */
bool label_file_colours(struct job *job, struct label_table *table, const char *path);

#endif
