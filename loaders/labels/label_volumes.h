/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The table beside a 4-D file that names its volumes. */
#ifndef CONUS_LOADERS_LABELS_LABEL_VOLUMES_H
#define CONUS_LOADERS_LABELS_LABEL_VOLUMES_H

#include "atlas/labels/labels.h"
#include "base/buffer.h"
#include "base/notes.h"
#include "loaders/labels/label_use.h"

/** The labels of all volumes of the file in @p use (info, max_memory, read), numbered by the volumes from 1, all with
 * names. The names come from the table @p path or, where that is NULL, from the table beside the file. Empty, with a
 * note, where no table says for certain which volume each name belongs to. @p from gets the table's file appended. A
 * damaged table that was given is CONUS_ERROR_DATA. */
conus_status label_volume_table(struct label_table *out, struct buffer *from, const char *path,
                                const struct label_use *use, struct notes *notes);

/** Appends to @p name the name that the table beside the volume's file, X.txt or another, gives to the volume, and the
 * table's file to @p from. Appends nothing where there is no such table; nor, with a note, where it does not say for
 * certain which volume each name belongs to. A file of one volume has no such table. */
conus_status label_volume_name(struct buffer *name, struct buffer *from, const conus_volume_info *info,
                               struct notes *notes);

#endif
