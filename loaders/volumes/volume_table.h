/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The label table of a volume: inside its file or beside it. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_TABLE_H
#define CONUS_LOADERS_VOLUMES_VOLUME_TABLE_H

#include "loaders/labels/label_find.h"
#include "loaders/volumes/volume_file.h"

/** label_table_of_volume() of the volume in @p file. Gives the words for where it comes from. */
const char *volume_label_table(struct job *job, struct label_table *out, const struct volume_file *file,
                               const struct label_voxels *voxels);

#endif
