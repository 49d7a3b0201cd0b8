/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How well the numbers of a table match those of a volume. */
#ifndef CONUS_LOADERS_LABELS_LABEL_FIT_H
#define CONUS_LOADERS_LABELS_LABEL_FIT_H

#include "atlas/labels/labels.h"
#include "loaders/labels/label_use.h"

struct label_fit {
    size_t names;     /**< Of the table.                                                */
    size_t used;      /**< Of them, those whose number a voxel has.                     */
    uint32_t unnamed; /**< The first number of a voxel that has no name, in the order of the voxels; 0: all have one. */
    size_t strays;    /**< Voxels whose number has no name,                             */
    size_t voxels;    /**< of so many that have one other than 0.                       */
};

/** Compares @p table with the voxels of @p use, which has some. */
conus_status label_fit_find(struct label_fit *out, const struct label_table *table, const struct label_use *use);

/** Whether it is good enough for a table that only its name connects with the volume: every number of a voxel has a
 * name, but for one in 100,000 voxels, nine in ten names have a voxel, and 0 is no area's. */
bool label_fit_is_good(const struct label_fit *fit, const struct label_table *table);

#endif
