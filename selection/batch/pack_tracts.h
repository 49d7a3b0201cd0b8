/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The tractograms of an atlas in a block of memory. */
#ifndef CONUS_SELECTION_BATCH_PACK_TRACTS_H
#define CONUS_SELECTION_BATCH_PACK_TRACTS_H

#include "atlas/atlas.h"
#include "selection/batch/pack_walk.h"

/** Passes @p count tractograms. Attached ones have their numbers in the block, and these are checked: no run, node,
 * streamline or member of a group leads out of its array. */
void pack_tractograms(struct pack_walk *walk, conus_atlas *atlas, size_t count);

/** Refuses objects, just attached, that are bundles of no tractogram or group. */
void pack_check_bundles(struct pack_walk *walk, const conus_atlas *atlas);

#endif
