/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The planes on which a volume is sampled (Eq. 7): perpendicular to the view axis, evenly over the volume's depth
 * range. The depth of a point is its distance from the eye along the view axis. One home for the numbers, so that every
 * pass and engine samples at the same places. */
#ifndef CONUS_RENDER_ID_SLICES_H
#define CONUS_RENDER_ID_SLICES_H

#include "base/status.h"

#include <stdint.h>

/** The part of a picture's planes that an ID pass takes when nobody says otherwise: the paper's. */
#define SLICES_FRACTION 0.2

struct slices {
    double start;   /**< Depth in mm at which the volume begins in front of the eye.  */
    double spacing; /**< mm between planes.                                           */
    uint32_t count; /**< 0 when the volume lies behind the eye.                       */
};

/** N when nobody says otherwise: floor(sqrt(2) max(dim)), the 362 of 256^3 (Eq. 7). */
uint32_t slices_default(const size_t dim[3]);

/** Planes of an ID pass, where a colour pass has @p slices (0 = the default): @p fraction of them, in (0, 1], 0 = a
 * fifth; rounded down, at least 1 (Eq. 7). */
uint32_t slices_of_id_pass(uint32_t slices, double fraction, const size_t dim[3]);

/** @p count planes through the cells of a grid of @p dim, seen from @p eye along the unit vector @p axis. */
struct slices slices_over(const size_t dim[3], const double world_from_voxel[16], const double eye[3],
                          const double axis[3], uint32_t count);

/** Depth of plane @p k, from 0 (Eq. 7). A ray with unit direction d hits it at depth * (1 / (d . axis)) mm. */
static inline double slices_depth(const struct slices *slices, uint32_t k)
{
    return slices->start + (k + 0.5) * slices->spacing;
}

#endif
