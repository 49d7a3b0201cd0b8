/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel that cuts rows of voxels, for any processor. */
#define LANES 4
#define KERNEL region_rows_cut_plain
#include "selection/region/region_rows_lanes.h"
