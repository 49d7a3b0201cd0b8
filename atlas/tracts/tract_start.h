/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The start of a search along a ray in a tractogram, in single precision, and the slack by which everything is
 * then enlarged, so that no segment is lost. Processor and GPU search from there (Eq. 18). */
#ifndef CONUS_ATLAS_TRACTS_TRACT_START_H
#define CONUS_ATLAS_TRACTS_TRACT_START_H

#include "atlas/tracts/tractogram.h"

/** Relative to the largest coordinate and to the radius: far above any rounding in single precision. */
#define TRACT_SLACK 1e-5

struct tract_start {
    double along;        /**< mm from the ray's origin to where the search begins, at the border of the tractogram. */
    float origin[3];     /**< That place. */
    float direction[3];  /**< Unit length. */
    float inverse[3];    /**< 1 / direction, finite. */
    float radius, slack; /**< mm; the slack is no part of the radius. */
};

/** Where the ray from @p origin enters the box around all capsules. False if it misses: then only radius and slack are
 * set, and nothing at all for a tractogram without a point. */
bool tract_start_find(struct tract_start *out, const struct tractogram *tractogram, const double origin[3],
                      const double direction[3]);

/** An upper bound in single precision: a place @p limit mm from the ray's origin is at most so far from the start. */
static inline float tract_start_reach(double limit, double along, float slack)
{
    return (float)((limit - along) * (1 + TRACT_SLACK)) + slack;
}

#endif
