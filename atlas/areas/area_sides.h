/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which areas are left and which are right ones, by what the atlas says. */
#ifndef CONUS_ATLAS_AREAS_AREA_SIDES_H
#define CONUS_ATLAS_AREAS_AREA_SIDES_H

#include "atlas/atlas.h"

/** Writes 'L', 'R', 'B' or 0 of each area by itself, by number, to @p out of [area_count + 1], which is zeroed: what
 * the table says, or which one of a pair it is (atlas/areas/pairs.h), or else a word in its name such as "left" or
 * "rh". On failure @p out may have been written to. */
conus_status area_sides_find(char *out, const conus_atlas *atlas);

#endif
