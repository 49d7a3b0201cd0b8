/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel of the walk for AVX-512. */
#define LANES 16
#define KERNEL traverse_trace_avx512
#define PIERCE traverse_pierce_avx512
#include "selection/engine/voxels/pierce_lanes.h"
