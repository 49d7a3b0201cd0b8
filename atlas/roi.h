/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A region of interest: the voxels of a volume whose value reaches a threshold. */
#ifndef CONUS_ATLAS_ROI_H
#define CONUS_ATLAS_ROI_H

#include "atlas/volume.h"
#include "conus/overlap.h"

struct conus_roi {
    struct volume volume;   /**< Without objects. */
    uint64_t voxels;        /**< How many the region has. */
    size_t low[3], high[3]; /**< Bounds of the region, both ends in it. */
};

/** Takes over @p values, scaled, one per voxel, on success; info->threshold says which of them count, as
 * conus_roi_options has it. Errors as of conus_roi_load(). */
conus_status roi_create(conus_roi **out, const conus_volume_info *info, float *values);

/** Whether a voxel of this value belongs to a region of this threshold. */
static inline bool roi_value_belongs(float value, float threshold)
{
    return threshold > 0   ? value >= threshold
           : threshold < 0 ? value <= threshold
                           : value != 0 && value == value; /* NaN belongs to nothing */
}

static inline bool roi_has(const conus_roi *roi, size_t voxel)
{
    return roi_value_belongs(roi->volume.values[voxel], (float)roi->volume.info.threshold);
}

#endif
