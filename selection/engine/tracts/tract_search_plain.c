/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel of the search for any processor. */
#define LANES 4
#define KERNEL tract_search_next_plain
#include "selection/engine/tracts/tract_search_lanes.h"
