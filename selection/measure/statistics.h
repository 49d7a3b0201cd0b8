/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From evidence to one result per object hit. */
#ifndef CONUS_SELECTION_MEASURE_STATISTICS_H
#define CONUS_SELECTION_MEASURE_STATISTICS_H

#include "selection/cone/aperture.h"
#include "selection/evidence/counts.h"
#include "selection/evidence/layers.h"
#include "selection/measure/census.h"
#include "selection/measure/near.h"
#include "selection/measure/solids.h"
#include "selection/measure/tract_census.h"
#include "selection/weight/weight.h"

struct statistics {
    conus_result *results; /**< In order of object number, then what hit nothing (object 0); kind,
                              rank and score are still to be set. */
    size_t count;
};

void statistics_finish(struct statistics *statistics);

/** Sums per object over pixels and rays, with a place for all objects: so the cost of a query depends on what it hits,
 * not on the size of the atlas. A zeroed one is ready for statistics_gather(). */
struct tally {
    struct tallied *objects; /**< [object_count + 1]; number 0 is what hit nothing.        */
    uint32_t *touched;       /**< [object_count + 1] Numbers of those that are not zeroed, */
    size_t touched_count;    /**< of which there are so many.                              */
    size_t object_count;
};

/** Reserves capacity for objects up to @p object_count. */
conus_status tally_prepare(struct tally *tally, size_t object_count);
void tally_finish(struct tally *tally);

/** The input of statistics_gather(). */
struct gathering {
    const conus_atlas *atlas;
    const struct cone *cone;
    const struct aperture *aperture; /**< Prepared for the cone; NULL where there are no pixels. */
    const struct evidence *evidence;
    const struct hit_counts *counts; /**< In its place, where an engine has counted; grouped already. Else NULL. */
    const struct soft *soft;         /**< Weights of pixels, of a cone with evidence; NULL = none.         */
    const struct layers *layers;     /**< Sorted; NULL = visible only.                                     */
    const struct census *census;     /**< The voxels in the cone or ball; with layers or near.           */
    const struct near *near; /**< The objects near to a ball's centre; with its census.                        */
    const struct tract_census *tracts; /**< The streamlines there, with a census; NULL = there is no bundle. */
    const struct tract_index *tract_index;
    const struct solids *solids; /**< Surfaces whose inside is counted; with a census. NULL = none. */
    const struct region *region; /**< In which it is; with solids.                                 */
    const double *whole;         /**< [object_count + 1] Whole volumes of the objects, with layers, mm^3.  */
    const uint32_t *group;       /**< [object_count + 1] As what each object is reported; NULL = itself. */
};

/** Gathers the results. For each object that an in-cone pixel hit first: pixels, share (Eq. 4), nearest distance,
 * smallest offset and contact (Eq. 11). With layers also pierced pixels, entry, exit and path length; and by census or
 * triangles (Eq. 10) what lies in the cone. An object with a voxel or some of its inside there has a result even if no
 * ray hits it; so has a bundle with a streamline there (Eq. 19). A ball has no pixels: its distance and contact are
 * those of the nearest points. @p tally is prepared for the atlas's objects. */
conus_status statistics_gather(struct statistics *out, const struct gathering *gathering, struct tally *tally);

/** The result of an object about which nothing is known. */
conus_result statistics_empty_result(uint32_t number);

#endif
