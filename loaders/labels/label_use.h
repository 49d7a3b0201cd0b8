/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The purpose for which a label table is read. */
#ifndef CONUS_LOADERS_LABELS_LABEL_USE_H
#define CONUS_LOADERS_LABELS_LABEL_USE_H

#include "atlas/labels/label_voxels.h"
#include "base/job/job.h"
#include "conus/atlas.h"

/** Reads the header of the volume @p path: volume_header_read(). */
typedef void label_header_read(struct job *job, conus_volume_info *out, const char *path);

/** Zero: for no volume that is known. */
struct label_use {
    const conus_volume_info *info;     /**< The volume that the table names, or NULL. */
    const struct label_voxels *voxels; /**< Its labels as they were read, i fastest; NULL if not known. */
    label_header_read *header; /**< For the image that an FSL atlas XML counts its voxels in; NULL: it is not read. */
    const char *path;          /**< The table's file, or NULL. */
    struct text columns[2];    /**< A header row's names for number and name; empty: the usual words. */
};

#endif
