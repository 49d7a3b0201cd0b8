/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The atlas in another space: all of it moved by an affine. */
#ifndef CONUS_ATLAS_PLACEMENT_H
#define CONUS_ATLAS_PLACEMENT_H

#include "atlas/atlas.h"

enum { PLACEMENT_WORDS = sizeof((conus_volume_info *)0)->transform };

/** The words of @p info's transform and @p how (", moved", ", warped") behind them, unless they have it. */
void placement_words(char out[PLACEMENT_WORDS], const conus_volume_info *info, const char *how);

/** Moves volumes and surfaces by the inverse of @p atlas_from_world, which maps a point of the new space to one of the
 * atlas. @p words name the transform in one line. Unchanged on failure: CONUS_ERROR_DATA for a matrix that cannot be
 * inverted or takes a vertex beyond 1e9 mm; CONUS_ERROR_MEMORY. */
conus_status atlas_move(conus_atlas *atlas, const double atlas_from_world[16], const char *words);

#endif
