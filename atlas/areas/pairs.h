/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which areas are left and right of one, and what such a pair is called. */
#ifndef CONUS_ATLAS_AREAS_PAIRS_H
#define CONUS_ATLAS_AREAS_PAIRS_H

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

/** The power of ten above all labels of areas, with room for three before it; CONUS_ERROR_UNSUPPORTED if there is none.
 */
conus_status hemispheres_label_step(uint32_t *out, const conus_atlas *atlas);

#endif
