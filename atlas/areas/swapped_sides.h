/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Do names of left and right areas fit where these lie? */
#ifndef CONUS_ATLAS_AREAS_SWAPPED_SIDES_H
#define CONUS_ATLAS_AREAS_SWAPPED_SIDES_H

#include "atlas/atlas.h"

/** Warns where at least three quarters of the pairs of a left and a right area (atlas/areas/pairs.h), and three of them
 * or more, lie the other way round: the left one at the larger mean x of voxels or vertices. Where the midline is does
 * not matter. Of large grids every so many-th row is looked at. CONUS_ERROR_MEMORY. */
conus_status swapped_sides_note(conus_atlas *atlas);

#endif
