/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The exact walk of rays through a volume's cells (Eq. 5), leaping over what is known to be empty.
 *
 * A ray is a point and a direction per mm in index space. It crosses the plane between cells b - 1 and b of axis a at
 * t_a(b) = (b - 1/2 - o_a) * (1 / d_a), evaluated as written. All its crossings, sorted by t and then by axis, make the
 * sequence of its cells; so the cell after any crossing is a function of that crossing alone, however it was reached,
 * and a leap to it gives the same bits as stepping there. */
#ifndef CONUS_SELECTION_TRAVERSE_H
#define CONUS_SELECTION_TRAVERSE_H

#include "selection/leap_map.h"

/** A ray, prepared. An axis along which it does not move has direction 0, inverse infinity, sign 1, and the centre of
 * its cell for origin. */
struct traverse_ray {
    double origin[3];
    double direction[3];
    double inverse[3];
    double sign[3]; /**< +1 or -1 */
};

/** A crossing: after it the ray is in the next cell of @p axis. */
struct traverse_crossing {
    double t;
    int axis;
};

/** The first voxel with an object. */
struct traverse_contact {
    double t;       /**< mm to the entry into its cell; 0 if the ray starts in it; INFINITY = none. */
    uint64_t voxel; /**< Linear index i + dim0 (j + dim1 k); UINT64_MAX = none.                     */
};

/** Index of the cell [i - 1/2, i + 1/2) that holds @p x. */
double traverse_cell(double x);

void traverse_ray_init(struct traverse_ray *out, const double origin[3], const double direction[3]);

/** The cell of @p axis in which the ray is just after @p crossing of another axis, when it was in @p from some time
 * before; @p end is the first cell beyond the grid in the ray's direction, past which it does not look. */
double traverse_cell_after(const struct traverse_ray *ray, int axis, struct traverse_crossing crossing, double from,
                           double end);

/** Walks one ray; gives up beyond @p limit mm. */
struct traverse_contact traverse_one(const struct leap_map *map, const struct traverse_ray *ray, double limit);

#endif
