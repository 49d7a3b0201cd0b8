/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file clearance.h
 * How far a needle stays from each object (Eq. 21).
 */
#ifndef CONUS_PUBLIC_CLEARANCE_H
#define CONUS_PUBLIC_CLEARANCE_H

#include <conus/selection.h>
#include <conus/table.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Finds how far the axis of a device stays from each object, occluded or not: from the near end of the selector's range
 * to its far end, or without one as far as objects reach. Of voxels the distance is that to their cells (Eq. 5), of a
 * mesh to its triangles, and 0 where the needle begins inside of a closed one, of streamlines to their tubes (Eq. 18).
 * The selector's radius is the needle's; without one it is 0. Its level holds: a group is as near as the nearest
 * of it. Rows are ordered by clearance, of equal ones by depth, then by object.
 * @param[out] out The columns of `conus query --clearance` (docs/formats.md) but query; end it with
 * conus_table_destroy().
 * @param selector The selector. Its engine and resolution do not matter.
 * @param pose Apex and axis.
 * @param within Objects with a larger clearance are left out, mm, 0 or more; INFINITY = none is.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid or a number out of its range.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_clearance(conus_table **out, conus_selector *selector, const conus_pose *pose,
                                           double within);

#ifdef __cplusplus
}
#endif

#endif
