/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The voxels of a .dlabel.nii as a parcellation. */
#ifndef CONUS_LOADERS_PLAN_CIFTI_PARCELLATION_H
#define CONUS_LOADERS_PLAN_CIFTI_PARCELLATION_H

#include "loaders/scene/load_parcellation.h"

/** Reads the voxels of @p path, which may choose a map, into file (without voxels), labels, table and source of @p out,
 * which is the caller's to finish, also on failure. CONUS_ERROR_DATA where the file has none. */
conus_status cifti_parcellation_read(struct parcellation *out, const char *path, uint64_t max_memory);

#endif
