/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file connectivity.h
 * Which areas the streamlines of bundles connect: all of them, or those that come into a cone (Eq. 20).
 */
#ifndef CONUS_PUBLIC_CONNECTIVITY_H
#define CONUS_PUBLIC_CONNECTIVITY_H

#include <conus/selection.h>
#include <conus/table.h>

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** mm: how far from an end its area is looked for, unless told. */
#define CONUS_ENDPOINT_RADIUS 2.0

/**
 * Finds the areas at both ends of streamlines: of all bundles that are not hidden, each streamline once for each of its
 * bundles. The selector's level holds. Streamlines have no direction: end_a is the area with the lower number; where
 * only one end has an area, end_b has none.
 *
 * The rows are about bundles: ordered by them, then by streamlines, the most first, then by end_a and end_b, none last.
 * With pairs the table has two parts. "pairs" has the columns without those of the bundle: the streamlines of all
 * bundles together, each counted once, whichever bundles it is in. Its area_a and area_b are rows of "areas", from 0,
 * which is the same for all bundles: the areas that have voxels or triangles and are not hidden, with ends or without,
 * ascending; after conus_atlas_show() with names, the areas named in the order of the names, also those without voxels
 * and triangles. The last row is that of ends in no area.
 * @param[out] out The columns of `conus connect` (docs/formats.md) but query; end it with conus_table_destroy().
 * @param selector The selector.
 * @param selection An answer of it, or of one of the same atlas: only streamlines that come into its cone, cylinder or
 * ball. NULL = all.
 * @param radius mm, up to 100: an end in no area has the nearest one within it. 0 = #CONUS_ENDPOINT_RADIUS; below 0 =
 * such an end has none.
 * @param with_pairs Whether the parts are wanted, too.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a radius out of its range, and for a selection of another atlas.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_connectivity(conus_table **out, conus_selector *selector,
                                              const conus_selection *selection, double radius, bool with_pairs);

#ifdef __cplusplus
}
#endif

#endif
