/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tractograms of any number of streamlines, in world mm about the origin, and cones at them. */
#ifndef CONUS_BENCH_SUPPORT_FIBRES_H
#define CONUS_BENCH_SUPPORT_FIBRES_H

#include "atlas/tracts/tractogram.h"
#include "selection/cone/cone.h"
#include "selection/engine/tracts/tract_rays.h"

enum fibres {
    FIBRES_WALKS,  /**< Random walks in an ellipsoid of a brain's size: neighbours run in all directions.             */
    FIBRES_HELICES /**< Straight lines and helices of one turn round the z axis, within 12 mm of it, as `conus phantom
                        bundle` has them: neighbours run alike. */
};

enum { FIBRES_POINTS = 100 }; /**< Of each streamline. */

/** Makes @p count streamlines with the default radius, and no tree. End them with tractogram_finish(), even if this
 * fails: CONUS_ERROR_MEMORY. */
conus_status fibres_make(struct tractogram *out, enum fibres kind, size_t count);

/** Cones of 16 x 16 rays, from 150 to 200 mm away, at what is within the inner half of all streamlines. */
conus_status fibres_cones(struct cone *out, size_t count, enum fibres kind, double degrees);

/** The rays of a cone. */
struct fibre_rays {
    double origin[3];
    double direction[3][TRACT_RAYS_LIMIT]; /**< Ray k is that of column aperture_column(k) and row aperture_row(k). */
};

void fibres_aim(struct fibre_rays *out, const struct cone *cone);

/** First hits along rays, which @p hits borrows. */
void fibres_walk(struct tract_bundle *hits, const struct tract_rays *rays, const struct fibre_rays *along);

#endif
