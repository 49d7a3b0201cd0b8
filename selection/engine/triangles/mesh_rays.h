/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Triangles along rays: the first (Eq. 9), all, and the intervals between them (Eq. 10). */
#ifndef CONUS_SELECTION_ENGINE_TRIANGLES_MESH_RAYS_H
#define CONUS_SELECTION_ENGINE_TRIANGLES_MESH_RAYS_H

#include "atlas/surface/mesh.h"
#include "selection/evidence/evidence.h"

/* From the points where rays pass through surfaces to the intervals between them (Eq. 10). An engine brings
 * crossings in any order, and may bring one more than once; what an interval is, is decided here for all of them. */

/** A point where a pixel's ray passes through a triangle. */
struct crossing {
    uint32_t pixel;
    uint32_t object;
    uint32_t triangle; /**< In the object's mesh.                           */
    int32_t side;      /**< mesh_crossing()'s.                              */
    double t;          /**< mesh_crossing()'s, in mm from the apex; 0 or more. */
};

/** Crossings of an n x n buffer, pixels outside the aperture too, and what pairing them needs. */
struct mesh_intervals {
    const conus_atlas *atlas; /**< Must outlive it.                                               */
    double slack;             /**< mm: crossings of neighbouring triangles within it may be one.  */
    struct crossing *crossings;
    size_t count, capacity;
    struct crossing *sorted; /**< [sorted_capacity] */
    size_t sorted_capacity;
    size_t *end; /**< [pixel_capacity] */
    size_t pixel_capacity;
};

void mesh_intervals_init(struct mesh_intervals *out, const conus_atlas *atlas);
void mesh_intervals_finish(struct mesh_intervals *intervals);

/** Reserves capacity for one more; called by mesh_intervals_add(). */
conus_status mesh_intervals_grow(struct mesh_intervals *intervals);

/** Appends a copy of @p crossing. */
static inline conus_status mesh_intervals_add(struct mesh_intervals *intervals, const struct crossing *crossing)
{
    conus_status status = intervals->count < intervals->capacity ? CONUS_OK : mesh_intervals_grow(intervals);
    if (!status) {
        intervals->crossings[intervals->count++] = *crossing;
    }
    return status;
}

/** Appends the intervals between the crossings of all of the cone's pixels to @p out, and drops the crossings: the
 * first hit of an object is where its first interval begins, to the bit, unless the apex is inside; then that is 0. */
conus_status mesh_intervals_pair(struct layers *out, struct mesh_intervals *intervals, const struct cone *cone);

/* The first triangle along rays (Eq. 9), or all (Eq. 10), found by a tracer (mesh_tracer.h), settled in double
 * precision.
 *
 * Embree works in single precision, so it only proposes: every triangle that it finds nearer than what a ray has, or
 * as near within its precision, is weighed by mesh_crossing(), and the nearest wins; of equally near ones that of the
 * lower object, then the lower triangle. What stays to Embree is whether a ray passes an edge on this side or that. The
 * tree of our own takes mesh_is_passed()'s word for that. */

/** A surface at its place. */
struct mesh_object {
    const struct mesh *mesh;       /**< Must outlive the rays. NULL = this object is no mesh.                      */
    const double *world_from_mesh; /**< Matrix that places it; NULL = it lies in world space. Objects in a row
                                        that have a matrix and the same mesh share its triangles in memory.       */
};

enum { MESH_RAYS_LIMIT = 256 };

/** Rays with one origin, neighbours side by side, and what each has hit so far. The caller fills in everything. */
struct mesh_bundle {
    size_t count;                               /**< At most MESH_RAYS_LIMIT.                       */
    const double *origin;                       /**< [3] in the world.                              */
    const double (*direction)[MESH_RAYS_LIMIT]; /**< [3][] in the world, unit length.               */
    uint32_t object[MESH_RAYS_LIMIT];           /**< Hit first so far; 0 = none.                    */
    double t[MESH_RAYS_LIMIT];                  /**< mm to it; INFINITY = none.                     */
    uint64_t triangle[MESH_RAYS_LIMIT];         /**< In its mesh, if mesh_rays_trace() found it.     */
};

struct mesh_rays;

/** Makes the surfaces ready; object number k is objects[k - 1]. */
conus_status mesh_rays_create(struct mesh_rays **out, const struct mesh_object *objects, size_t count);

/** CONUS_OK, or where a build with Embree finds none, CONUS_ERROR_UNSUPPORTED: the tree of our own then stands in. */
conus_status mesh_rays_load_embree(void);

/** NULL is fine. */
void mesh_rays_destroy(struct mesh_rays *rays);

/** Looks for nearer contacts than those that @p bundle has, @p width rays at once: 1, 4, 8 or 16. All give the same
 * answer and differ in speed. */
conus_status mesh_rays_trace(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width);

/** Appends all crossings of all of the bundle's rays with all surfaces to @p out (Eq. 10), whatever the rays have hit;
 * ray k is that of pixel[k]. Leaves t undefined. */
conus_status mesh_rays_pierce(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out,
                              const size_t *pixel);

/** The width to take for rays from @p apex that are @p pitch radians apart: 16 as long as neighbours hit the scene
 * less than a triangle's cell apart, else 1. The cell is the cube root of the scene's volume per triangle. */
unsigned mesh_rays_width(const struct mesh_rays *rays, const double apex[3], double pitch);

#endif
