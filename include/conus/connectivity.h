/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file connectivity.h
 * Which areas the streamlines of bundles connect: all of them, or those that come into a cone (Eq. 20).
 */
#ifndef CONUS_PUBLIC_CONNECTIVITY_H
#define CONUS_PUBLIC_CONNECTIVITY_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** mm: how far from an end its area is looked for, unless told. */
#define CONUS_ENDPOINT_RADIUS 2.0

typedef struct conus_connectivity conus_connectivity; /**< Which areas streamlines connect. */

/** How the areas of ends are found. */
typedef struct conus_connectivity_options {
    size_t struct_size; /**< Its size, as #CONUS_CONNECTIVITY_OPTIONS_INIT sets it; 0 = that of this version. */
    double radius;      /**< mm, up to 100: an end in no area has the nearest one within it. 0 = #CONUS_ENDPOINT_RADIUS;
                           below 0 = such an end has none. */
} conus_connectivity_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CONNECTIVITY_OPTIONS_INIT CONUS_INIT_(conus_connectivity_options)

/** Streamlines whose ends are in the same two areas. They have no direction: area_a is the lower number. */
typedef struct conus_connection {
    uint32_t bundle;      /**< Number of the bundle in the atlas; 0 in conus_connectivity_pair(): of all bundles. */
    uint32_t area_a;      /**< Number of the area at one end, as it is reported (level); 0 = none, unassigned. */
    uint32_t area_b;      /**< Likewise at the other end. Where only one has an area, this one has none. */
    uint64_t streamlines; /**< How many. */
    double fraction;      /**< They as a part of the streamlines of that bundle that were looked at; these sum to 1. */
    double length;        /**< Their mean length, mm, in or out of the cone. */
} conus_connection;

/**
 * Finds the areas at both ends of streamlines: of all bundles that are not hidden, each streamline once for each of its
 * bundles. The selector's level holds.
 * @param[out] out The connectivity; end it with conus_connectivity_destroy().
 * @param selector The selector.
 * @param selection An answer of it, or of one of the same atlas: only streamlines that come into its cone, cylinder or
 * ball. NULL = all.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a radius out of its range, and for a selection of another atlas.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_connectivity_create(conus_connectivity **out, conus_selector *selector,
                                                     const conus_selection *selection,
                                                     const conus_connectivity_options *options);

/**
 * Ends a connectivity.
 * @param connectivity NULL is allowed.
 * @threads One at a time for each @p connectivity.
 * @since 0.1
 */
CONUS_API void conus_connectivity_destroy(conus_connectivity *connectivity);

/**
 * Counts the connections. They are ordered by bundle, then by streamlines, the most first, then by area_a and area_b,
 * 0 last.
 * @param connectivity NULL counts 0.
 * @return How many connections there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_connectivity_count(const conus_connectivity *connectivity);

/**
 * Gives connection @p index.
 * @param connectivity The connectivity.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the connectivity.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_connection *conus_connectivity_connection(const conus_connectivity *connectivity, size_t index);

/**
 * Counts the pairs of areas that are connected by any bundle.
 * @param connectivity NULL counts 0.
 * @return How many pairs there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_connectivity_pair_count(const conus_connectivity *connectivity);

/**
 * Gives a pair of areas with the streamlines of all bundles together, each counted once, whichever bundles it is in.
 * @param connectivity The connectivity.
 * @param index From 0; ordered as connections are.
 * @return NULL past the last. Borrowed from the connectivity.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_connection *conus_connectivity_pair(const conus_connectivity *connectivity, size_t index);

/** The pairs as a table, area by area. */
typedef struct conus_connection_matrix {
    size_t count; /**< Number of areas that have voxels or triangles and are not hidden, with ends or without, and one
                     more for ends in no area. It is the same for all bundles. */
    const uint32_t *areas;       /**< [count] Their numbers, as they are reported (level), ascending; after
                                    conus_atlas_show() with names, the areas named in the order of the names, also those
                                    without voxels and triangles. 0, the ends without an area, is last. */
    const uint64_t *streamlines; /**< [count count] How many connect the two, symmetric. On the diagonal: both ends are
                                    in the area. */
    const double *length;        /**< [count count] Their mean length, mm; NaN where there are none. */
} conus_connection_matrix;

/**
 * Lays the pairs out as a table.
 * @param[out] out Its arrays are borrowed from the connectivity.
 * @param connectivity The connectivity.
 * @return #CONUS_OK; #CONUS_ERROR_UNSUPPORTED for more than 8192 areas.
 * @threads One at a time for each @p connectivity.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_connectivity_matrix(conus_connection_matrix *out, conus_connectivity *connectivity);

#ifdef __cplusplus
}
#endif

#endif
