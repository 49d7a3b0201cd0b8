/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The labels of a volume as an array. */
#ifndef CONUS_TESTS_SUPPORT_LABEL_LIST_H
#define CONUS_TESTS_SUPPORT_LABEL_LIST_H

#include "base/memory.h"
#include "volume_on_job.h"

/** The labels, one per voxel, the caller's to memory_free(); NULL without memory. */
static inline uint32_t *label_list(const struct label_voxels *voxels)
{
    uint32_t *list = memory_raw(voxels->count, sizeof *list);
    if (list) {
        label_voxels_get(list, voxels, 0, voxels->count);
    }
    return list;
}

/** The same for volume_file_labels(); NULL on failure. */
static inline conus_status label_list_read(uint32_t **out, struct volume_file *file)
{
    struct label_voxels voxels = {0};
    conus_status status = volume_file_labels(&voxels, file);
    *out = status ? NULL : label_list(&voxels);
    label_voxels_finish(&voxels);
    return status || *out ? status : CONUS_ERROR_MEMORY;
}

#endif
