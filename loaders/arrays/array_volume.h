/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A volume in memory, as if a file had been opened. */
#ifndef CONUS_LOADERS_ARRAYS_ARRAY_VOLUME_H
#define CONUS_LOADERS_ARRAYS_ARRAY_VOLUME_H

#include "conus/conus.h"
#include "loaders/volumes/volume_file.h"

struct array_volume {
    struct volume_file file; /**< Its voxels are i fastest, without gaps. */
    bool is_borrowed;        /**< They are the caller's. */
};

/** Checks @p voxels, which must outlive @p out. CONUS_ERROR_ARGUMENT for what is out of its range, CONUS_ERROR_DATA for
 * a matrix that cannot be inverted. */
conus_status array_volume_open(struct array_volume *out, const conus_voxels *voxels);
void array_volume_finish(struct array_volume *array);

#endif
