/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel of the walk for AVX2. */
#define LANES 8
#define KERNEL traverse_trace_avx2
#define PIERCE traverse_pierce_avx2
#include "selection/engine/voxels/pierce_lanes.h"
