/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The first triangle along rays (Eq. 9), or all (Eq. 10), found by a tracer (mesh_tracer.h), settled in double
 * precision.
 *
 * Embree works in single precision, so it only proposes: every triangle that it finds nearer than what a ray has, or
 * as near within its precision, is weighed by mesh_crossing(), and the nearest wins; of equally near ones that of the
 * lower object, then the lower triangle. What stays to Embree is whether a ray passes an edge on this side or that. The
 * tree of our own takes mesh_is_passed()'s word for that. */
#ifndef CONUS_SELECTION_ENGINE_TRIANGLES_MESH_RAYS_H
#define CONUS_SELECTION_ENGINE_TRIANGLES_MESH_RAYS_H

#include "atlas/surface/mesh.h"
#include "selection/engine/triangles/mesh_intervals.h"

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
