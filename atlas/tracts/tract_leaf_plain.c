/* SPDX-License-Identifier: BSD-3-Clause */
/* The kernel that makes leaves, for any processor. */
#define KERNEL tract_leaf_set_plain
#include "atlas/tracts/tract_leaf_lanes.h"
