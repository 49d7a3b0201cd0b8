/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file clearance.h
 * How far a needle stays from each object (Eq. 21).
 */
#ifndef CONUS_PUBLIC_CLEARANCE_H
#define CONUS_PUBLIC_CLEARANCE_H

#include <conus/selection.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_clearances conus_clearances; /**< Distances of objects from a needle, the nearest first. */

/** How far an object is from a needle (Eq. 21). */
typedef struct conus_clearance {
    conus_kind kind;  /**< Its kind. */
    uint32_t object;  /**< Number in the atlas, as it is reported (level). */
    double distance;  /**< mm from the needle's axis to the object, 0 where they meet. */
    double clearance; /**< The distance less the needle's radius, mm; negative where the needle's body meets it. */
    double depth;     /**< mm from the apex to the point of the axis that is nearest; of several the least. */
    double at[3];     /**< World position of that point of the axis, mm. */
    double near[3];   /**< World position of the object's nearest point, mm. */
} conus_clearance;

/**
 * Finds how far the axis of a device stays from each object, occluded or not: from the near end of the selector's range
 * to its far end, or without one as far as objects reach. Of voxels the distance is that to their cells (Eq. 5), of a
 * mesh to its triangles, and 0 where the needle begins inside of a closed one, of streamlines to their tubes (Eq. 18).
 * The selector's radius is the needle's; without one it is 0. Its level holds: a group is as near as the nearest
 * of it.
 * @param[out] out The clearances; end it with conus_clearances_destroy().
 * @param selector The selector. Its engine and resolution do not matter.
 * @param pose Apex and axis.
 * @param within Objects with a larger clearance are left out, mm, 0 or more; INFINITY = none is.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid or a number out of its range.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_clearances_create(conus_clearances **out, conus_selector *selector,
                                                   const conus_pose *pose, double within);

/**
 * Ends what conus_clearances_create() made.
 * @param clearances NULL is allowed.
 * @threads One at a time for each @p clearances.
 * @since 0.1
 */
CONUS_API void conus_clearances_destroy(conus_clearances *clearances);

/**
 * Counts the objects. They are ordered by clearance, of equal ones by depth, then by object.
 * @param clearances NULL counts 0.
 * @return How many there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_clearances_count(const conus_clearances *clearances);

/**
 * Gives clearance @p index.
 * @param clearances The clearances.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the clearances.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_clearance *conus_clearances_clearance(const conus_clearances *clearances, size_t index);

#ifdef __cplusplus
}
#endif

#endif
