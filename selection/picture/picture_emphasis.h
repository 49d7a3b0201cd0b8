/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How areas stand out in a picture with a cone; apart from OpenGL's structures, for cuts that need none. */
#ifndef CONUS_SELECTION_PICTURE_PICTURE_EMPHASIS_H
#define CONUS_SELECTION_PICTURE_PICTURE_EMPHASIS_H

#include "selection/selection.h"

/** How each object, by number, stands out in a picture of @p selection: [object count + 1] of enum emphasis, to be
 * freed. @p chosen (0 = none) and what is below it in the area tree are never pale. NULL without memory. */
uint8_t *picture_emphasis(const conus_selection *selection, uint32_t chosen);

/** How far along the axis the farthest contact lies, mm; -INFINITY where nothing is hit. */
double picture_cone_depth(const conus_selection *selection);

/** Whether a picture of @p selection, which may be NULL, colours by rank: unless @p own_colours, or where the atlas has
 * a palette, which somebody chose. */
bool picture_has_ranks(const conus_selection *selection, bool own_colours);

/** conus_selection_rank() of each object, by number: [object count + 1], to be freed. NULL without memory. */
uint32_t *picture_ranks(const conus_selection *selection);

enum { PICTURE_RANKS = 6 };
/** sRGB of each object by its rank, to be freed; where the atlas has a palette its colours, but what has a rank has
 * none that a better one has, while there are some: of [object count + 1] @p ranks; 0, and all where that is NULL,
 * = @p not_hit, 0xRRGGBB, but what is @p listed ([object count + 1]; NULL = nothing is) has its own colour, so that
 * nothing that is not hit has the colour of a hit. With a @p selection as much of a rank's colour shows as
 * conus_selection_weight() says, and the rest is @p not_hit. NULL without memory. */
uint8_t (*picture_rank_colours(const uint32_t *ranks, const conus_atlas *atlas, unsigned not_hit, const bool *listed,
                               const conus_selection *selection))[3];

#endif
