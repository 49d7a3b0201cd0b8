/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The inside of the surfaces around the areas, as a volume that head_make() takes. */
#ifndef CONUS_ATLAS_FIT_SURFACE_HEAD_H
#define CONUS_ATLAS_FIT_SURFACE_HEAD_H

#include "atlas/atlas.h"

enum { SURFACE_HEAD_CELLS = 120 }; /**< Along the longest edge of the box around the surfaces. */

/** Fills @p out with 1 in voxels whose centre is in a closed surface of atlas->context_surfaces, and 0 elsewhere: cubes
 * over the box around these surfaces. No values where none is closed. CONUS_ERROR_MEMORY. */
conus_status surface_head_make(struct volume *out, const conus_atlas *atlas);

#endif
