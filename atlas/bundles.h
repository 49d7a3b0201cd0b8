/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Bundles: objects of an atlas that are streamlines, made from a tractogram. */
#ifndef CONUS_ATLAS_BUNDLES_H
#define CONUS_ATLAS_BUNDLES_H

#include "atlas/atlas.h"

/** object_place.group of a bundle of all streamlines of its tractogram. */
#define BUNDLE_OF_ALL SIZE_MAX

/** Grows the tree of the checked @p tractogram. If it has groups, and some streamlines are in none, appends a group of
 * these, without a name. On failure it may have its tree. */
conus_status bundles_ready(struct tractogram *tractogram);

/** Makes the checked @p tractogram ready, unless it is, and appends it to @p atlas, with one bundle called @p name for
 * all of its streamlines. If it has groups: one bundle for each, by the group's name, and one called @p name for the
 * streamlines in no group. On success the tractogram is taken over; on failure it may have its tree and that group, and
 * the atlas is unchanged. CONUS_ERROR_ARGUMENT if a pathway or bundle has one of these names. */
conus_status atlas_add_tractogram(conus_atlas *atlas, struct tractogram *tractogram, const char *name);

/** The tractogram of object @p number, hidden or not; NULL if it is no bundle. */
const struct tractogram *atlas_bundle_tractogram(const conus_atlas *atlas, uint32_t number);

/** The group of streamlines of its tractogram that the bundle @p number is; NULL = all. */
const struct tract_group *atlas_bundle_group(const conus_atlas *atlas, uint32_t number);

/** Whether there is a bundle that is not hidden. */
bool atlas_has_bundles(const conus_atlas *atlas);

/** The object as which each streamline of @p tractogram, one of the atlas's, is shown: the first bundle that has it and
 * is not hidden. @p objects [streamline_count] is all 0 before, and stays so where there is none. */
void bundles_find_objects(uint32_t *objects, const conus_atlas *atlas, const struct tractogram *tractogram);

/** Moves all points of @p atlas's tractograms by @p world_from_atlas: new tractograms in @p out, [tractogram_count],
 * with points, point_count, tree and bounds only. CONUS_ERROR_DATA if a point leaves TRACT_COORDINATE_LIMIT;
 * CONUS_ERROR_MEMORY. On failure @p out has nothing to free. */
conus_status bundles_move(struct tractogram *out, const conus_atlas *atlas, const double world_from_atlas[16]);

/** Gives @p atlas those points and trees, or a whole tractogram where @p moved has its `first`, with as many groups as
 * before; and measures its bundles anew. @p moved gets the old ones, to be freed. */
void bundles_take(conus_atlas *atlas, struct tractogram *moved);

#endif
