/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Regions of interest made of cubes, and their overlaps (Eq. 16). */
#ifndef CONUS_TESTS_SUPPORT_REGION_SCENE_H
#define CONUS_TESTS_SUPPORT_REGION_SCENE_H

#include "conus/study.h"

/** @p values on a grid of cubes, the first voxel's middle at @p corner. */
conus_voxels region_scene_cubes(const float *values, const size_t dim[3], double edge, const double corner[3]);

/** End it with conus_roi_destroy(). */
conus_roi *region_scene_make(const conus_voxels *voxels, double threshold);

/** All of a grid of @p count cubes along each edge, up to 32. */
conus_roi *region_scene_whole(size_t count, double edge, const double corner[3]);

/** End it with conus_table_destroy(). */
conus_table *region_scene_overlap(const conus_atlas *atlas, const conus_roi *roi, const char *level);

/** The row of an object; all 0 where there is none. */
struct region_scene_row {
    bool is_there;
    double volume, volume_error, fraction, roi_fraction, peak, peak_point[3];
};

struct region_scene_row region_scene_find(const conus_table *overlap, uint32_t object);

/** Two slabs of 1 mm voxels, x < 4 and x >= 4, of 8 x 8 x 8. End it with conus_atlas_destroy(). */
conus_atlas *region_scene_slabs(void);

#endif
