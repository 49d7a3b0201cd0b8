/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A small atlas whose areas have sides, numbers for names, names with commas, and one lies on both sides. */
#ifndef CONUS_TESTS_BUILDERS_PLACE_ATLAS_H
#define CONUS_TESTS_BUILDERS_PLACE_ATLAS_H

#include "conus/arrays.h"

#include <stdlib.h>
#include <string.h>

/** 12 x 4 x 4 voxels of 1 mm, the first at (-5.5, 0, 0); areas are slabs of x. Core_L is of x -5.5 to -3.5, with the
 * inner point (-4.5, 1, 1), Core_R of 3.5 to 5.5, with (4.5, 1, 1); 17 is x -0.5 and 0.5. */
static inline conus_atlas *place_atlas(void)
{
    static uint8_t labels[12 * 4 * 4];
    static const conus_label names[] = {{.number = 1, .name = "Core_L", .abbreviation = "C.L"},
                                        {.number = 2, .name = "Core_R", .abbreviation = "C.R"},
                                        {.number = 3, .name = "1, 2, 3"},
                                        {.number = 17, .name = "17"},
                                        {.number = 4, .name = "Area Fp1 (left)"},
                                        {.number = 5, .name = "L_A1_ROI"},
                                        {.number = 6, .name = "R_A1_ROI"}};
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT8, .dim = {12, 4, 4}};
    const double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -5.5, 0, 0, 1};
    conus_atlas *atlas = NULL;
    memcpy(voxels.world_from_voxel, matrix, sizeof matrix);
    for (size_t i = 0; i < sizeof labels; i++) {
        static const uint8_t by_x[] = {1, 1, 1, 3, 4, 17, 17, 5, 6, 2, 2, 2};
        labels[i] = by_x[i % 12];
    }
    if (conus_atlas_create(&atlas, &voxels, names, sizeof names / sizeof names[0], NULL)) {
        abort();
    }
    return atlas;
}

#endif
