/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The first streamline along rays, and all of them (Eq. 18): tract_search.h finds segments, capsule_interval() settles
 * in double, so that nothing depends on how they were found. */
#ifndef CONUS_SELECTION_ENGINE_TRACTS_TRACT_RAYS_H
#define CONUS_SELECTION_ENGINE_TRACTS_TRACT_RAYS_H

#include "atlas/tracts/tractogram.h"
#include "selection/engine/tracts/tract_search.h"
#include "selection/evidence/layers.h"

/** Streamlines as an object. */
struct tract_object {
    const struct tractogram *tractogram; /**< With its tree; must outlive the rays. */
    const struct tract_group *group;     /**< One of its groups; NULL = all streamlines. */
    uint32_t number;                     /**< The object's, from 1. */
};

enum { TRACT_RAYS_LIMIT = 256 };

/** Rays with one origin, and what each has hit so far. The caller fills in everything. */
struct tract_bundle {
    size_t count;                                /**< At most TRACT_RAYS_LIMIT.                */
    const double *origin;                        /**< [3] in the world.                        */
    const double (*direction)[TRACT_RAYS_LIMIT]; /**< [3][] in the world, unit length.         */
    uint32_t object[TRACT_RAYS_LIMIT];           /**< Hit first so far; 0 = none.              */
    double t[TRACT_RAYS_LIMIT];                  /**< mm to it; INFINITY = none.               */
    uint64_t point[TRACT_RAYS_LIMIT]; /**< The first one of the segment that is hit, of all of its tractogram,
                                           if tract_rays_trace() found it.           */
};

struct tract_rays;

/** Makes @p count objects ready, by ascending numbers. CONUS_ERROR_MEMORY. */
conus_status tract_rays_create(struct tract_rays **out, const struct tract_object *objects, size_t count);

/** The same with a kernel of the caller's choice. */
conus_status tract_rays_create_with(struct tract_rays **out, tract_search_next *next,
                                    const struct tract_object *objects, size_t count);

/** NULL is fine. */
void tract_rays_destroy(struct tract_rays *rays);

/** Looks for nearer contacts than those that @p bundle has; of equally near ones the object with the lower number wins,
 * then the lower point. A streamline of several objects is that of the lowest. */
void tract_rays_trace(const struct tract_rays *rays, struct tract_bundle *bundle);

/** Appends all intervals of all of the bundle's rays in all objects to @p out (Eq. 10), whatever the rays have hit; ray
 * k is that of pixel[k]. What an interval has for a voxel is the first point of the segment where it begins.
 * CONUS_ERROR_MEMORY. */
conus_status tract_rays_pierce(const struct tract_rays *rays, const struct tract_bundle *bundle, struct layers *out,
                               const size_t *pixel);

#endif
