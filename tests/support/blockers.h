/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A context volume whose voxels block what lies behind them. */
#ifndef CONUS_TESTS_SUPPORT_BLOCKERS_H
#define CONUS_TESTS_SUPPORT_BLOCKERS_H

#include "conus/conus.h"

/** Adds a context on a random grid of @p dim voxels (scene_grid()); each voxel blocks with probability @p share. */
void blockers_add(conus_atlas *atlas, uint64_t *random, const size_t dim[3], double share);

#endif
