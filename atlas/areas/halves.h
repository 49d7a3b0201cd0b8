/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Areas of both hemispheres, cut in two. */
#ifndef CONUS_ATLAS_AREAS_HALVES_H
#define CONUS_ATLAS_AREAS_HALVES_H

#include "atlas/atlas.h"

/** Cuts voxels' areas that are on both sides in two: voxels with a centre at world x < 0 and the others. The halves'
 * labels are the area's with a 1 or 2 before it; areas above them become two, too. Areas with a side, by pair or table
 * or a name like "Left-vessel", or because all their voxels are on it, stay whole, and so do areas without a voxel.
 * CONUS_ERROR_DATA where nothing can be cut, CONUS_ERROR_UNSUPPORTED where there are meshes. */
conus_status hemispheres_split(conus_atlas *atlas);

#endif
