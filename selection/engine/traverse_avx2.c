/* SPDX-License-Identifier: BSD-3-Clause */
#define LANES 8
#define KERNEL traverse_walk_avx2
#include "selection/engine/traverse_lanes.h"
