/* SPDX-License-Identifier: BSD-3-Clause */
#define LANES 16
#define KERNEL traverse_walk_avx512
#include "selection/engine/traverse_lanes.h"
