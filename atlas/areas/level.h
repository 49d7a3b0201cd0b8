/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Levels: the objects as which those of an atlas are reported, by rolling areas up the area tree (Eq. 10). */
#ifndef CONUS_ATLAS_AREAS_LEVEL_H
#define CONUS_ATLAS_AREAS_LEVEL_H

#include "atlas/atlas.h"
#include "conus/atlas.h"

struct level;

/** Makes the level that @p spec describes: a whole number N, or a list of areas.
 *
 * N is a depth in the area tree, whose roots have depth 1: areas deeper than N are reported as their ancestor at depth
 * N, others as themselves. A list has areas by name, abbreviation or label, separated by commas: an area is reported as
 * the nearest one on the list among itself and its ancestors, as itself if there is none. A name with a comma stands in
 * double quotes, and a quoted number is a label even if it stands alone. An item @FILE stands for the lines of that
 * file: one area each, never quoted; empty lines and those that begin with # do not count. Names match to the letter,
 * or else in upper or lower case where that leaves one area. An area that was cut in two stands for both halves.
 *
 * NULL reports every object as itself. Where hemispheres are merged (atlas/areas/hemispheres.c), that is after both
 * areas of a pair became their common one, whose depth both have. Pathways are always themselves. Errors:
 * CONUS_ERROR_ARGUMENT without a tree, beyond its depth, and for items that are no area or several; CONUS_ERROR_IO for
 * the file. */
conus_status level_create(struct level **out, const conus_atlas *atlas, const char *spec);

/** NULL is fine. */
void level_destroy(struct level *level);

/** [object_count + 1] the object as which each is reported; 0 for 0. NULL without a level. */
const uint32_t *level_group(const struct level *level);

/** The areas of a level that is a list, by number; @p count is 0 for another level. For records of the question, since
 * a file of areas may change. */
const uint32_t *level_areas(const struct level *level, size_t *count);

/** Whether every object is reported as itself, as without a level. */
bool level_is_identity(const struct level *level);

#endif
