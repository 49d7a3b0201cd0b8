/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of interest: voxels of a volume. */
#include "atlas/roi.h"

#include "base/memory.h"
#include "base/text.h"

#include <math.h>

/* Whether the volume has one value beside 0, as masks have. */
static bool is_mask(const float *values, size_t count)
{
    float one = 0;
    for (size_t i = 0; i < count; i++) {
        if (roi_value_belongs(values[i], 0) && values[i] != one) {
            if (one != 0) {
                return false;
            }
            one = values[i];
        }
    }
    return true;
}

static void include(conus_roi *roi, size_t voxel)
{
    const size_t *dim = roi->volume.info.dim;
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    for (int a = 0; a < 3; a++) {
        roi->low[a] = !roi->voxels || at[a] < roi->low[a] ? at[a] : roi->low[a];
        roi->high[a] = !roi->voxels || at[a] > roi->high[a] ? at[a] : roi->high[a];
    }
    roi->voxels++;
}

static conus_status mark(conus_roi *roi)
{
    const conus_volume_info *info = &roi->volume.info;
    char words[3][TEXT_NUMBER_SIZE];
    text_number(words[0], info->threshold);
    text_number(words[1], info->minimum);
    text_number(words[2], info->maximum);
    if (!isfinite(info->threshold)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: threshold %s, a finite number is needed", info->path, words[0]);
    }
    if (info->threshold == 0 && !is_mask(roi->volume.values, roi->volume.voxel_count)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%s: has values from %s to %s and is no mask: a threshold is needed, from which on a voxel belongs "
                    "to the region (below 0: down from which)",
                    info->path, words[1], words[2]);
    }
    for (size_t i = 0; i < roi->volume.voxel_count; i++) {
        if (roi_has(roi, i)) {
            include(roi, i);
        }
    }
    if (roi->voxels) {
        return CONUS_OK;
    }
    return info->threshold == 0 ? fail(CONUS_ERROR_DATA, "%s: no voxel differs from 0", info->path)
                                : fail(CONUS_ERROR_ARGUMENT, "%s: threshold %s, but its values are from %s to %s",
                                       info->path, words[0], words[1], words[2]);
}

conus_status roi_create(conus_roi **out, const conus_volume_info *info, float *values)
{
    conus_roi *roi = memory_zeroed(1, sizeof *roi);
    conus_status status = roi ? volume_init(&roi->volume, info) : CONUS_ERROR_MEMORY;
    if (!status) {
        roi->volume.values = values;
        status = mark(roi);
    }
    if (status) {
        if (roi) {
            roi->volume.values = NULL; /* the caller's still */
        }
        conus_roi_destroy(roi);
        return status;
    }
    *out = roi;
    return CONUS_OK;
}

void conus_roi_destroy(conus_roi *roi)
{
    if (roi) {
        volume_finish(&roi->volume);
        memory_free(roi);
    }
}

const conus_volume_info *conus_roi_volume(const conus_roi *roi)
{
    return &roi->volume.info;
}

uint64_t conus_roi_voxels(const conus_roi *roi)
{
    return roi ? roi->voxels : 0;
}
