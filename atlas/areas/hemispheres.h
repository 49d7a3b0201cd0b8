/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Left and right areas: which are a pair, pairs as one, one as a pair. */
#ifndef CONUS_ATLAS_AREAS_HEMISPHERES_H
#define CONUS_ATLAS_AREAS_HEMISPHERES_H

#include "atlas/atlas.h"
#include "base/buffer.h"

/** Finds the areas that are left and right of one. Two are a pair if their names differ in nothing but a word for the
 * side (atlas/areas/sides.h), or are equal and the table gives L for one and R for the other; if no other area could
 * take the place of either; if what the table says of their hemispheres does not contradict; and if they have the same
 * parent, or their parents are a pair. @p out is [area_count + 1]: of a left area the number of the right one, else 0.
 * memory_free() it. */
conus_status hemispheres_pair(uint32_t **out, const conus_atlas *atlas);

/** Appends what the names of a left and a right area have in common: without the word for the side, or the whole name
 * if they are equal. Nothing if they differ otherwise. */
void hemispheres_common_name(struct buffer *out, const char *left, const char *right);

/** Adds an area above each pair, with the pair's name without the side; level_create() then reports pairs as it. Its
 * label is the left one's with a 3 before it, at the place that no label reaches. CONUS_ERROR_DATA without a pair. */
conus_status hemispheres_merge(conus_atlas *atlas);

/** Cuts voxels' areas that are on both sides in two: voxels with a centre at world x < 0 and the others. The halves'
 * labels are the area's with a 1 or 2 before it; areas above them become two, too. Areas with a side, by pair or table
 * or a name like "Left-vessel", or because all their voxels are on it, stay whole, and so do areas without a voxel.
 * CONUS_ERROR_DATA where nothing can be cut, CONUS_ERROR_UNSUPPORTED where there are meshes. */
conus_status hemispheres_split(conus_atlas *atlas);

/** The power of ten above all labels of areas, with room for three before it; CONUS_ERROR_UNSUPPORTED if there is none.
 */
conus_status hemispheres_label_step(uint32_t *out, const conus_atlas *atlas);

#endif
