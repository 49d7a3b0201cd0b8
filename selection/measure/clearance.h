/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How far a needle stays from objects: from the cells of their voxels, their triangles, their tubes (Eq. 21). */
#ifndef CONUS_SELECTION_MEASURE_CLEARANCE_H
#define CONUS_SELECTION_MEASURE_CLEARANCE_H

#include "atlas/atlas.h"
#include "atlas/surface/bvh.h"
#include "base/geometry/needle.h"
#include "selection/measure/tract_census.h"

/** Distances of objects, or of groups of them; kept between needles. A zeroed one is ready for clearance_prepare(). */
struct clearance {
    struct clearance_found {
        double distance; /**< mm; INFINITY if none was found.                                                     */
        double depth;    /**< Where the needle is so near, the least depth.                                       */
        double point[3]; /**< The nearest point there, world mm.                                                  */
        uint64_t source; /**< The volume, mesh or tractogram that has it, in the order in which they are asked,   */
        uint64_t part;   /**< and its voxel, triangle or point there: of equal ones the lowest.                   */
    } * found;           /**< [object_count + 1]                                                                  */
    uint32_t *touched;   /**< Those that are found, in no order.                                                  */
    size_t touched_count;
    size_t object_count;
};

/** Reserves capacity for the objects of @p atlas. */
conus_status clearance_prepare(struct clearance *clearance, const conus_atlas *atlas);
void clearance_finish(struct clearance *clearance);

/** The voxels of one object in a cube of CLEARANCE_BRICK^3 voxels: the first and last along each axis. */
struct clearance_brick {
    uint32_t object;
    uint32_t first[3], last[3];
};
enum { CLEARANCE_BRICK = 4 };

/** Where the objects of an atlas are. It follows from the atlas and does not change: all threads share it. */
struct clearance_index {
    struct clearance_brick *bricks; /**< [brick_count] By object. */
    size_t brick_count;
    struct bvh *trees; /**< [object_count + 1] The box of the object's triangles in the world, or of its bricks in
                          indices; empty for a bundle, and for an object that has no shape or is hidden. */
    size_t object_count;
    double low[3], high[3]; /**< Round all that can be near, world mm; low above high where that is nothing. */
};

/** Looks at all voxels and triangles. CONUS_ERROR_MEMORY. */
conus_status clearance_index_create(struct clearance_index **out, const conus_atlas *atlas);
/** NULL is fine. */
void clearance_index_destroy(struct clearance_index *index);

/** The query to an atlas. */
struct clearance_question {
    const conus_atlas *atlas;
    const struct clearance_index *index;
    const struct tract_index *tracts; /**< Its streamlines' owners; NULL leaves bundles out. */
    const uint32_t *groups; /**< [object_count + 1] What each object counts as, a number up to object_count: the least
                               of a group is found. 0 = it takes no part. NULL = all count as 1: only the nearest of
                               all objects is found. */
    double limit;           /**< mm: what is farther is not found; finite. */
};

/** Forgets the last needle's and finds all groups that are no farther from @p needle than the limit. An answer does not
 * depend on the limit, nor on what else is asked. The context takes no part, and nothing that is hidden. */
void clearance_take(struct clearance *clearance, const struct clearance_question *question,
                    const struct needle *needle);

#endif
