/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The oracle of Eq. 5: Amanatides and Woo's traversal (Eurographics 1987) in double, one ray, one voxel at a
 * time, over object numbers, without skipping anything. Also the baseline that conus-bench measures against. */
#ifndef CONUS_TESTS_SUPPORT_ORACLE_TRAVERSAL_H
#define CONUS_TESTS_SUPPORT_ORACLE_TRAVERSAL_H

#include "selection/engine/engine.h"

struct oracle_hit {
    uint32_t object; /**< 0 = none. */
    double distance;
    uint64_t voxel;
};

/** Traces a ray; @p origin and @p direction are in index space, the direction per mm. */
struct oracle_hit oracle_ray(const struct volume *volume, const double origin[3], const double direction[3]);

/** The evidence that an engine's trace() must give for all volumes of @p atlas but the context. */
void oracle_trace(struct evidence *out, const conus_atlas *atlas, const struct cone *cone);

#endif
