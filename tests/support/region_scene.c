/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of interest made of cubes, and their overlaps. */
#include "region_scene.h"

#include "scene.h"
#include "tables.h"
#include "test.h"

conus_voxels region_scene_cubes(const float *values, const size_t dim[3], double edge, const double corner[3])
{
    conus_voxels voxels = {.data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {dim[0], dim[1], dim[2]}};
    for (int a = 0; a < 3; a++) {
        voxels.world_from_voxel[5 * a] = edge;
        voxels.world_from_voxel[12 + a] = corner[a];
    }
    voxels.world_from_voxel[15] = 1;
    return voxels;
}

conus_roi *region_scene_make(const conus_voxels *voxels, double threshold)
{
    conus_roi *roi = NULL;
    assert_ok(conus_roi_create(&roi, voxels, &(conus_roi_options){.threshold = threshold}));
    return roi;
}

conus_roi *region_scene_whole(size_t count, double edge, const double corner[3])
{
    static float ones[32 * 32 * 32];
    for (size_t i = 0; i < sizeof ones / sizeof *ones; i++) {
        ones[i] = 1;
    }
    const conus_voxels voxels = region_scene_cubes(ones, (const size_t[]){count, count, count}, edge, corner);
    return region_scene_make(&voxels, 0);
}

conus_table *region_scene_overlap(const conus_atlas *atlas, const conus_roi *roi, const char *level)
{
    conus_selector *selector = NULL;
    conus_table *overlap = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.level = level}));
    assert_ok(conus_overlap(&overlap, selector, roi));
    conus_selector_destroy(selector);
    return overlap;
}

struct region_scene_row region_scene_find(const conus_table *overlap, uint32_t object)
{
    size_t index = table_row_of(overlap, object);
    struct region_scene_row row = {.is_there = index < conus_table_rows(overlap)};
    if (row.is_there) {
        row.volume = table_number_at(overlap, "volume_mm3", index);
        row.volume_error = table_number_at(overlap, "volume_error_mm3", index);
        row.fraction = table_number_at(overlap, "fraction", index);
        row.roi_fraction = table_number_at(overlap, "region_fraction", index);
        row.peak = table_number_at(overlap, "peak", index);
        table_point_at(row.peak_point, overlap, "peak_", index);
    }
    return row;
}

conus_atlas *region_scene_slabs(void)
{
    uint32_t labels[512];
    for (size_t i = 0; i < 512; i++) {
        labels[i] = i % 8 < 4 ? 1 : 2;
    }
    const conus_volume_info grid = scene_plain_grid((const size_t[]){8, 8, 8}, NULL);
    return scene_parcellation(&grid, labels);
}
