/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel that makes leaves, for AVX2. */
#define KERNEL tract_leaf_set_avx2
#include "atlas/tracts/tract_leaf_lanes.h"
