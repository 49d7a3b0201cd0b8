/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Label tables in the formats in which they lie beside or inside volumes. What a table is, is told by its content
 * (columns and their types), never by its file name. docs/formats.md lists the formats and the order of the search. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FILES_H
#define CONUS_LOADERS_LABELS_LABEL_FILES_H

#include "atlas/labels.h"
#include "loaders/labels/label_use.h"
#include "loaders/volumes/volume_file.h"

/** Parses a label table of any known format for @p use; *format is its name in words ("ITK-SNAP labels"), static.
 * @p out is sorted, and the caller's to finish. CONUS_ERROR_DATA when the bytes are of no known format or damaged. */
conus_status label_bytes_parse(struct label_table *out, const char **format, const uint8_t *data, size_t size,
                               const struct label_use *use, struct notes *notes);

/** Reads the label table @p path (and, for a table without colours, X.lut beside it). @p use may be NULL. */
conus_status label_file_read(struct label_table *out, const char **format, const char *path,
                             const struct label_use *use, struct notes *notes);

/** Finds the table of @p volume, whose labels are @p voxels (NULL: numbers are not checked): inside the file, then
 * beside it, in the documented order. Tables that contradict each other are CONUS_ERROR_DATA. @p source becomes words
 * for it ("MRIcron text in aal.nii.txt", "none found"), the caller's to memory_free(); no table is no error: an empty
 * @p out. @p read, unless NULL, gets the files that the table is of, other than the volume's. A table that is damaged
 * is an error only if nothing else is found; else a note. */
conus_status label_table_of_volume(struct label_table *out, char **source, const struct volume_file *volume,
                                   const uint32_t *voxels, struct file_sums *read, struct notes *notes);

#endif
