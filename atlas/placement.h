/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas in another space: all of it moved by an affine. */
#ifndef CONUS_ATLAS_PLACEMENT_H
#define CONUS_ATLAS_PLACEMENT_H

#include "atlas/atlas.h"

/** Moves volumes and surfaces to where @p atlas_from_world has them: what is at p in the atlas as it is comes to lie
 * where the matrix leads to p. @p words say in one line what moves it. Unchanged on failure: CONUS_ERROR_DATA for a
 * matrix that cannot be inverted or takes a vertex beyond 1e9 mm; CONUS_ERROR_MEMORY. */
conus_status atlas_move(conus_atlas *atlas, const double atlas_from_world[16], const char *words);

#endif
