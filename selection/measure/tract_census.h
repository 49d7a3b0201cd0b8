/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The census of streamlines (Eq. 19): which of them come into a region, and what they amount to for each bundle. It
 * goes by the tractogram's tree, but the order of that changes no bit. */
#ifndef CONUS_SELECTION_MEASURE_TRACT_CENSUS_H
#define CONUS_SELECTION_MEASURE_TRACT_CENSUS_H

#include "atlas/atlas.h"
#include "selection/region/region.h"

/** The part of a run of segments in a region, and, added up, that of the streamlines of a bundle. */
struct tract_part {
    uint64_t whole_mm, parts; /**< Length: mm, and 2^-40 mm; whole numbers, whose sum has no order.             */
    uint32_t streamlines;     /**< For a run 1. */
    uint32_t streamline;      /**< Which one has the point nearest to the region's origin;                      */
    uint64_t point;           /**< that is on the segment from this point of the tractogram on,                 */
    double s;                 /**< so far along it, 0 to 1,                                                     */
    double square;            /**< and this is the square of its distance, mm^2. Of equal ones the first point. */
    double near[3];           /**< It, in the world, mm.                                                        */
};

/** Length, mm. */
double tract_part_length(const struct tract_part *part);

/** A run that lies partly in the region, and its part there. */
typedef void (*tract_run_inside)(void *user, const struct tract_run *run, const struct tract_part *part);

/** Calls @p visit for all runs of @p tractogram with a part in @p region, in the order of its tree. */
void tract_census_walk(const struct tractogram *tractogram, const struct region *region, tract_run_inside visit,
                       void *user);

/** Finds which streamlines of bundle @p number come into @p region: their numbers in the tractogram, from 0, ascending,
 * in @p out, to be ended with memory_free(). CONUS_ERROR_MEMORY. */
conus_status tract_census_list(uint32_t **out, size_t *count, const conus_atlas *atlas, uint32_t number,
                               const struct region *region);

/** Whose the streamlines are, hidden or not, and how bundles run. It follows from the atlas and does not change:
 * selectors of all threads share it. */
struct tract_index {
    struct tract_owners {
        uint32_t all;      /**< The bundle of all streamlines; 0 where there are groups. Then                     */
        uint64_t *first;   /**< [streamline_count + 1] bundles[first[k]] to before bundles[first[k + 1]]          */
        uint32_t *bundles; /**< have streamline k.                                                                */
        size_t before;     /**< How many streamlines the tractograms before have.                                 */
    } * of;                /**< [tractogram_count]                                                                */
    double (*ends)[2][3];  /**< [object_count + 1] Ends of a bundle's longest streamline, of equal ones the first; in
                              the world, mm. */
    size_t tractogram_count;
    size_t streamline_count; /**< In all tractograms. */
};

/** Takes as long as it takes to read the points of all bundles. CONUS_ERROR_MEMORY. */
conus_status tract_index_create(struct tract_index **out, const conus_atlas *atlas);
void tract_index_destroy(struct tract_index *index);

/** How far along its streamline the nearest point of bundle @p number is, 0 to 1 of its length, where that is turned so
 * as to run like the bundle's longest one. NAN of a streamline without a length. */
double tract_index_along(const struct tract_index *index, const conus_atlas *atlas, uint32_t number,
                         const struct tract_part *part);

/** Counts of all objects, kept between regions, so that a query costs what is near it. A zeroed one is ready for
 * tract_census_prepare(). */
struct tract_census {
    struct tract_part *parts; /**< [object_count + 1] */
    uint32_t *touched;        /**< Bundles with a streamline in the region, in ascending order. */
    size_t touched_count;
    uint32_t *seen;  /**< [streamline_count of the index] Number of the last region in which it was. */
    uint32_t region; /**< Number of the last one. */
};

/** Reserves capacity for what @p index has of @p atlas. */
conus_status tract_census_prepare(struct tract_census *census, const struct tract_index *index,
                                  const conus_atlas *atlas);
void tract_census_finish(struct tract_census *census);

/** Forgets the last region's counts and takes those of @p region. Hidden bundles are left out. */
void tract_census_take(struct tract_census *census, const struct tract_index *index, const conus_atlas *atlas,
                       const struct region *region);

#endif
