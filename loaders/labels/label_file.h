/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A label table from a file. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FILE_H
#define CONUS_LOADERS_LABELS_LABEL_FILE_H

#include "atlas/labels/labels.h"
#include "base/files/file.h"
#include "loaders/labels/label_use.h"

/** Takes @p text apart at ",label=COLUMN" and ",name=COLUMN", in either order, unless there is a file of that name:
 * *path is the caller's to memory_free(), @p columns lie in @p text, empty where none is given. CONUS_ERROR_ARGUMENT.
 */
conus_status label_path_split(char **path, struct text columns[2], const char *text);

/** Reads the label table @p path, as label_path_split() takes it apart (and, for a table without colours, X.lut beside
 * it). @p use may be NULL. */
conus_status label_file_read(struct label_table *out, const char **format, const char *path,
                             const struct label_use *use, struct notes *notes);

/** Bytes that a file may have so that its table takes no more than @p max_memory; 0 = the default. */
uint64_t label_file_limit(uint64_t max_memory);

/** Reads the bytes of a file, at most label_file_limit(). */
conus_status label_file_bytes(struct bytes *out, const char *path, uint64_t max_memory);

bool label_table_has_colours(const struct label_table *table);

/** Colours @p table from the .lut @p path, and adds that to @p read, unless NULL; *found = false if it has no
 * colours alone (MRIcron's, FSLeyes's without names) or is not there. */
conus_status label_file_colours(struct label_table *table, bool *found, const char *path, struct file_sums *read);

#endif
