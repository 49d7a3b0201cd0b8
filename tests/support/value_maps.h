/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes of values, given one by one, as an atlas takes them. */
#ifndef CONUS_TESTS_SUPPORT_VALUE_MAPS_H
#define CONUS_TESTS_SUPPORT_VALUE_MAPS_H

#include "atlas/atlas.h"
#include "base/memory.h"

static inline size_t values_of(const conus_volume_info *info)
{
    return info->dim[0] * info->dim[1] * info->dim[2];
}

/** Calls atlas_add_pathway(); frees @p values, one a voxel, on success. */
static inline conus_status pathway_of_values(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                             const char *name)
{
    struct value_map map = {0};
    conus_status status = value_map_of(&map, values, values_of(info));
    status = status ? status : atlas_add_pathway(atlas, info, &map, name);
    value_map_finish(&map);
    memory_free(status ? NULL : values);
    return status;
}

/** The same of atlas_add_probabilistic_area(). */
static inline conus_status area_of_values(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                          const conus_object *area)
{
    struct value_map map = {0};
    conus_status status = value_map_of(&map, values, values_of(info));
    status = status ? status : atlas_add_probabilistic_area(atlas, info, &map, area);
    value_map_finish(&map);
    memory_free(status ? NULL : values);
    return status;
}

/** The same of atlas_add_bands(). */
static inline conus_status bands_of_values(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                           const conus_band *bands, size_t count)
{
    struct value_map map = {0};
    conus_status status = value_map_of(&map, values, values_of(info));
    status = status ? status : atlas_add_bands(atlas, info, &map, bands, count);
    value_map_finish(&map);
    memory_free(status ? NULL : values);
    return status;
}

/** All values of a volume, the caller's to memory_free(); NULL without memory. */
static inline float *values_copy(const struct volume *volume)
{
    float *values = memory_raw(volume->voxel_count, sizeof *values);
    for (size_t v = 0; values && v < volume->voxel_count; v++) {
        values[v] = volume_value(volume, v);
    }
    return values;
}

#endif
