/* SPDX-License-Identifier: BSD-3-Clause */
/* Three bands of a volume of distances. The middle lies between voxels, so twice the distance is the root of a sum of
 * three odd squares, and a radius R is passed where that sum is 4 R^2 or more: in whole numbers, with no rounding. */
#include "shells.h"

#include "base/geometry/math3.h"
#include "conus/arrays.h"
#include "test.h"

#include <math.h>

enum { DIM = SHELLS_DIM };

const conus_band shells[3] = {{-INFINITY, 8, "Core"}, {8, 14, "Middle"}, {14, 20, "Outer"}};
static int odd_square(size_t index)
{
    int twice = 2 * (int)index - (DIM - 1);
    return twice * twice;
}

uint32_t shell_of(const size_t at[3])
{
    int sum = odd_square(at[0]) + odd_square(at[1]) + odd_square(at[2]);
    return sum < 4 * 8 * 8 ? CORE : sum < 4 * 14 * 14 ? MIDDLE : sum < 4 * 20 * 20 ? OUTER : 0;
}

conus_atlas *shells_atlas(void)
{
    static float values[DIM * DIM * DIM];
    conus_voxels voxels = {.data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {DIM, DIM, DIM}, .name = "ramp"};
    const conus_pathway_options options = {.bands = shells, .band_count = 3};
    conus_atlas *atlas = NULL;
    mat4_identity(voxels.world_from_voxel);
    for (size_t a = 0; a < 3; a++) {
        voxels.world_from_voxel[12 + a] = -(DIM - 1) / 2.0; /* the middle is the world's origin */
    }
    for (size_t v = 0; v < DIM * DIM * DIM; v++) {
        const size_t at[3] = {v % DIM, v / DIM % DIM, v / DIM / DIM};
        values[v] = (float)(sqrt(odd_square(at[0]) + odd_square(at[1]) + odd_square(at[2])) / 2);
    }
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    assert_ok(conus_atlas_add_pathway_voxels(atlas, &voxels, &options));
    return atlas;
}
