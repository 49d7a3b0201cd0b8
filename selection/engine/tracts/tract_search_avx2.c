/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel of the search for AVX2. */
#define LANES 8
#define KERNEL tract_search_next_avx2
#include "selection/engine/tracts/tract_search_lanes.h"
