/* SPDX-License-Identifier: BSD-3-Clause */
/** @file FreeSurfer's names, for its volumes away from its colour table. */
#ifndef CONUS_LOADERS_LABELS_FREESURFER_NAMES_H
#define CONUS_LOADERS_LABELS_FREESURFER_NAMES_H

#include "loaders/labels/label_use.h"
#include "loaders/labels/labels_on_job.h"

/** Appends those labels of @p voxels to @p out that FreeSurfer's table has. */
void freesurfer_names_add(struct job *job, struct label_table *out, const struct label_voxels *voxels);

#endif
