/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The interface of the programs that trace rays through surfaces, Embree and our own tree; and the code that
 * both share. */
#ifndef CONUS_SELECTION_ENGINE_TRIANGLES_MESH_TRACER_H
#define CONUS_SELECTION_ENGINE_TRIANGLES_MESH_TRACER_H

#include "base/geometry/math3.h"
#include "selection/engine/triangles/mesh_rays.h"

struct surface {
    const struct mesh *mesh;       /**< NULL = this object is none. */
    const uint32_t *triangles;     /**< The mesh's,                */
    const float *positions;        /**< so that both are at hand.   */
    const double *mesh_from_world; /**< NULL = the identity         */
};

struct mesh_rays {
    const struct mesh_tracer *tracer;
    void *scene;                   /**< The tracer's.                       */
    struct surface *surfaces;      /**< [count]                             */
    double (*mesh_from_world)[16]; /**< [count] if any surface has one      */
    struct box3 bounds;            /**< Of everything.                      */
    double slack;                  /**< mm                                  */
    double cell;                   /**< mm: how far apart triangles are.    */
};

/** Finds the triangles that rays hit. */
struct mesh_tracer {
    const char *name; /**< "Embree 3.13.5" or "own tree". */
    /** Makes rays->scene of objects[count]; those of object k are surfaces[k], too. */
    conus_status (*create)(struct mesh_rays *rays, const struct mesh_object *objects, size_t count);
    /** Ends rays->scene, NULL too. */
    void (*destroy)(struct mesh_rays *rays);
    /** mesh_rays_trace() */
    conus_status (*trace)(struct mesh_rays *rays, struct mesh_bundle *bundle, unsigned width);
    /** Appends all crossings, with the number of the ray in the bundle as pixel; mesh_rays_pierce() fills in distances
     * and sides, and drops what lies behind the apex. t of all rays is INFINITY. */
    conus_status (*pierce)(struct mesh_rays *rays, struct mesh_bundle *bundle, struct mesh_intervals *out);
};

#if CONUS_EMBREE
extern const struct mesh_tracer mesh_embree;
#endif

/** Slower, of any processor, and settled in double alone: of two triangles that share an edge a ray hits one. */
extern const struct mesh_tracer mesh_bvh;

/** mesh_rays_create() with a tracer of the caller's choice. */
conus_status mesh_rays_create_with(struct mesh_rays **out, const struct mesh_tracer *tracer,
                                   const struct mesh_object *objects, size_t count);

/** mesh_crossing() of a ray of the bundle and a triangle of object number @p object. */
static inline double mesh_tracer_distance(int *side, const struct mesh_rays *rays, const struct mesh_bundle *bundle,
                                          size_t ray, uint32_t object, uint32_t triangle)
{
    const struct surface *surface = &rays->surfaces[object - 1];
    double direction[3] = {bundle->direction[0][ray], bundle->direction[1][ray], bundle->direction[2][ray]};
    if (!surface->mesh_from_world) {
        return mesh_crossing(side, surface->mesh, triangle, bundle->origin, direction);
    }
    double origin[3];
    mat4_point(origin, surface->mesh_from_world, bundle->origin);
    mat4_direction(direction, surface->mesh_from_world, direction);
    return mesh_crossing(side, surface->mesh, triangle, origin, direction);
}

/** Gives a ray a triangle if it is the first so far (Eq. 9): the nearest; of equally near ones that of the lower
 * object, then the lower triangle. True if so. */
static inline bool mesh_tracer_offer(const struct mesh_rays *rays, struct mesh_bundle *bundle, size_t ray,
                                     uint32_t object, uint32_t triangle)
{
    int side;
    double t = mesh_tracer_distance(&side, rays, bundle, ray, object, triangle);
    bool is_lower = object < bundle->object[ray] || (object == bundle->object[ray] && triangle < bundle->triangle[ray]);
    if (!(t >= 0) || t > bundle->t[ray] || (t == bundle->t[ray] && !is_lower)) {
        return false;
    }
    bundle->t[ray] = t;
    bundle->object[ray] = object;
    bundle->triangle[ray] = triangle;
    return true;
}

/** mm from the apex to where a tracer's rays begin: a little before the nearest point of the scene's bounds, so that
 * far apexes cost no precision; a little behind the apex, and negative, where that is inside. */
static inline double mesh_tracer_start(const struct mesh_rays *rays, const double apex[3])
{
    double away[3];
    for (int a = 0; a < 3; a++) {
        away[a] = fmax(fmax(rays->bounds.low[a] - apex[a], apex[a] - rays->bounds.high[a]), 0);
    }
    return vec3_length(away) - rays->slack;
}

/** mm from there on that a ray has to look no farther: behind what it has hit, and a little more. */
static inline double mesh_tracer_reach(const struct mesh_rays *rays, const struct mesh_bundle *bundle, size_t ray,
                                       double start)
{
    return bundle->t[ray] - start + rays->slack;
}

#endif
