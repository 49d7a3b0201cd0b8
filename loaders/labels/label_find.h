/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The label table of a volume: inside the file, then beside it (docs/formats.md has the order). */
#ifndef CONUS_LOADERS_LABELS_LABEL_FIND_H
#define CONUS_LOADERS_LABELS_LABEL_FIND_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** A volume whose table is wanted, and what its file says of labels by itself. All of it is borrowed. */
struct label_volume {
    const conus_volume_info *info;
    struct label_table *segments; /**< 3D Slicer's segments, sorted, which are taken out of it; NULL = none. */
    const struct text *texts;     /**< [count] Tables, perhaps, inside the file: the best first. */
    size_t count;
    label_header_read *header;
};

/** Finds the table of @p volume, whose labels are @p voxels (NULL: numbers are not checked): inside the file, then
 * beside it, in the documented order. Tables that contradict each other are CONUS_ERROR_DATA. Fills @p out, which is
 * empty; *source is words for it ("MRIcron text in aal.nii.txt", "none found"). No table is no error: @p out stays
 * empty. The job's files get those that the table is of, other than the volume's. A table that is damaged is an error
 * only if nothing else is found; else a note. */
void label_table_of_volume(struct job *job, struct label_table *out, const char **source,
                           const struct label_volume *volume, const struct label_voxels *voxels);

#endif
