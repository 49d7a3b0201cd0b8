/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The label table of a volume: inside the file, then beside it (docs/formats.md has the order). */
#ifndef CONUS_LOADERS_LABELS_LABEL_FIND_H
#define CONUS_LOADERS_LABELS_LABEL_FIND_H

#include "atlas/labels/labels.h"
#include "loaders/labels/label_use.h"

/** A volume whose table is wanted, and what its file says of labels by itself. */
struct label_volume {
    const conus_volume_info *info;
    uint64_t max_memory;
    struct label_table segments; /**< 3D Slicer's segments, sorted; owned. */
    struct notes notes;          /**< Notes about the segments. */
    struct text *texts;          /**< [count] Tables, perhaps, inside the file: the best first; owned. */
    size_t count;
    label_header_read *header;
};

void label_volume_finish(struct label_volume *volume);

/** Finds the table of @p volume, whose segments and notes it takes, and whose labels are @p voxels (NULL: numbers are
 * not checked): inside the file, then beside it, in the documented order. Tables that contradict each other are
 * CONUS_ERROR_DATA. @p source becomes words for it ("MRIcron text in aal.nii.txt", "none found"), the caller's to
 * memory_free(); no table is no error: an empty
 * @p out. @p read, unless NULL, gets the files that the table is of, other than the volume's. A table that is damaged
 * is an error only if nothing else is found; else a note. */
conus_status label_table_of_volume(struct label_table *out, char **source, struct label_volume *volume,
                                   const struct label_voxels *voxels, struct file_sums *read, struct notes *notes);

#endif
