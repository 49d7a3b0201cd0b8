/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What pictures show of an atlas with pathways (Eq. 8): these, and some areas, on one grid. */
#ifndef CONUS_RENDER_COLOUR_PATHWAYS_H
#define CONUS_RENDER_COLOUR_PATHWAYS_H

#include "atlas/atlas.h"

/** The first pathway that is not hidden; NULL if there is none. */
const struct volume *pathways_first(const conus_atlas *atlas);

/** A volume without values of all pathways and of the areas that @p drawn [object_count + 1] names (NULL = none), on
 * the grid of pathways_first(), extended; where both are, of the area. */
conus_status pathways_join(struct volume *out, const conus_atlas *atlas, const bool *drawn);

#endif
