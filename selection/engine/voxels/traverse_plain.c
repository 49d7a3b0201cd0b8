/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel of the walk for any processor. */
#define LANES 4
#define KERNEL traverse_trace_plain
#define PIERCE traverse_pierce_plain
#include "selection/engine/voxels/pierce_lanes.h"
