/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Streamlines along rays: the search, and what settles its hits (Eq. 18). */
#ifndef CONUS_SELECTION_ENGINE_TRACTS_TRACT_RAYS_H
#define CONUS_SELECTION_ENGINE_TRACTS_TRACT_RAYS_H

#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "selection/evidence/evidence.h"

/* A search along a ray in the tree of a tractogram, for segments that it may hit (Eq. 18). It works in single
 * precision with everything taken to be a little larger than it is, so that no segment is lost; capsule_interval()
 * decides. */

/** Segments of one run. */
struct tract_found {
    uint64_t point;    /**< The run's first one. */
    uint32_t segments; /**< In the run; 0 = its point alone. */
    uint32_t hit;      /**< Bit k: the segment from point + k on, or the point alone. */
};

/** Limits of the two stacks of a search: each level leaves fewer than TRACT_WIDTH items waiting; runs are put aside. */
enum { TRACT_WAITING = TRACT_WIDTH * TRACT_LEVELS, TRACT_ASIDE = TRACT_LEAF + 16 };

/** A search on its way. */
struct tract_search {
    const struct tractogram *tractogram;
    struct tract_levels levels;
    struct tract_start from;
    float slopes[TRACT_DIAGONALS]; /**< 1 / how much farther along a diagonal the ray is after a mm; finite. */
    float axes[3][3];              /**< Unit vectors, square to each other; the last one is the direction. */
    bool has_bound;                /**< Only the first hit is asked for, and any streamline may be it. */
    float bound;                   /**< mm from the search's origin: with a bound the first hit is no farther. */
    size_t waiting;
    size_t aside;       /**< Runs that are put aside; once they are sorted out,    */
    size_t ready, next; /**< so many are ready, and those from the next one are left. */
    struct tract_visit {
        float enter;    /**< mm from the search's origin: the ray is not in the item before. */
        uint32_t level; /**< 0 a run, 1 a leaf, l + 1 an item of level l. */
        size_t item;
    } visits[TRACT_WAITING], runs[TRACT_ASIDE]; /**< Stacks: the last one comes first. */
};

/** Begins a search along the ray from @p origin; @p tractogram must outlive it. */
void tract_search_init(struct tract_search *out, const struct tractogram *tractogram, const double origin[3],
                       const double direction[3]);

/** The next run, roughly from near to far, that may have a segment which the ray hits at @p limit mm from its origin or
 * before; false after the last. The limit may shrink from call to call. */
typedef bool tract_search_next(struct tract_found *out, struct tract_search *search, double limit);

/** The fastest one that this machine supports. */
tract_search_next *tract_search_best(void);

/** Number @p index of them, the fastest first; NULL where this machine does not support it, or past the last. */
tract_search_next *tract_search_kernel(size_t index);
enum { TRACT_SEARCH_KERNELS = 2 };

/* The first streamline along rays, and all of them (Eq. 18): tract_search.c finds segments, capsule_interval()
 * settles in double, so that nothing depends on how they were found. */

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
