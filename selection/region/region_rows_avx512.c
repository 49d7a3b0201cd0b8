/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel that cuts rows of voxels, for AVX-512. */
#define LANES 16
#define KERNEL region_rows_cut_avx512
#include "selection/region/region_rows_lanes.h"
