/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The table beside a 4-D file that names its volumes. */
#ifndef CONUS_LOADERS_LABELS_LABEL_VOLUMES_H
#define CONUS_LOADERS_LABELS_LABEL_VOLUMES_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** Fills the empty @p out with the labels of all volumes of the file in @p use (info), numbered by the
 * volumes from 1, all with names. The names come from the table @p path or, where that is NULL, from the table beside
 * the file. It stays empty, with a note, where no table says for certain which volume each name belongs to. Gives the
 * table's file without its folder, NULL where there is none; the job's files get it. A damaged table that was given is
 * CONUS_ERROR_DATA. */
const char *label_volume_table(struct job *job, struct label_table *out, const char *path, const struct label_use *use);

/** The name that the table beside the volume's file, X.txt or another, gives to the volume, and in *from the table's
 * file without its folder, which the job's files do not get. NULL, both, where there is no such table; or, with a note,
 * where it does not say for certain which volume each name belongs to. A file of one volume has no such table. */
const char *label_volume_name(struct job *job, const char **from, const conus_volume_info *info);

#endif
