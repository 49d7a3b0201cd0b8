/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel that cuts rows of voxels, for AVX2. */
#define LANES 8
#define KERNEL region_rows_cut_avx2
#include "selection/region/region_rows_lanes.h"
