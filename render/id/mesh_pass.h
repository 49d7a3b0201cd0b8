/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The mesh ID pass (Eq. 9): which triangle each pixel of n x n buffers hits first. Needs a current context throughout.
 *
 * The device leaves out the clusters of triangles that a view cannot show, and draws the others, which the CPU never
 * sees. The driver proposes the triangles that cover a pixel's centre and are the nearest within rounding, and
 * mesh_distance() settles in double precision which of them is: nearest first; of equally near ones that of the lower
 * object, then the lower triangle.
 *
 * Many queries are read back at once. What a query draws, and where on the driver's grid, does not depend on its
 * neighbours.
 */
#ifndef CONUS_RENDER_ID_MESH_PASS_H
#define CONUS_RENDER_ID_MESH_PASS_H

#include "atlas/surface/mesh.h"
#include "base/status.h"

struct mesh_pass;

/** Where the buffer looks from (Eq. 1, Eq. 3): either slope or radius is 0. */
struct mesh_view {
    const double *world_from_device; /**< [16] rigid; looks down its -z.                          */
    double slope;                    /**< Tangent of half the opening angle.                      */
    double radius;                   /**< A cylinder's parallel rays: half the buffer's edge, mm. */
    uint32_t resolution;             /**< n                                                       */
};

/** A pixel's ray in the world; direction is a unit vector. */
struct mesh_ray {
    double origin[3], direction[3];
};

/** The first hit of each pixel's ray so far; bottom row first, [n n] each. */
struct mesh_pixels {
    const struct mesh_ray *rays; /**< Those of the view's pixels.      */
    uint32_t *objects;           /**< In and out: 0 = none.            */
    double *distances;           /**< In and out: mm; INFINITY = none. */
    uint64_t *triangles;         /**< Out, where a mesh is hit first.  */
};

/** One view, and the pixels to fill. */
struct mesh_query {
    struct mesh_view view;
    struct mesh_pixels pixels;
};

/** A triangle that covers a pixel's centre. */
struct mesh_pass_hit {
    uint32_t pixel, object;
    uint32_t triangle; /**< In the object's mesh. */
};

/** Takes hits in any order. */
typedef conus_status (*mesh_pass_take)(void *user, const struct mesh_pass_hit *hit);

/** Uploads meshes, which must outlive the pass; object number k is meshes[k - 1], NULL = it is none. Takes their size
 * on the device off @p memory_left. */
conus_status mesh_pass_create(struct mesh_pass **out, const struct mesh *const *meshes, size_t count,
                              uint64_t *memory_left);
/** NULL is fine. */
void mesh_pass_destroy(struct mesh_pass *pass);

/** Draws the meshes for @p count queries, all of one resolution. A pixel takes a mesh's hit if it is nearer than the
 * hit that it has. */
conus_status mesh_pass_render(struct mesh_pass *pass, const struct mesh_query *queries, size_t count);

/** Hands to @p take every triangle that covers a pixel's centre, whatever hides it (Eq. 10); in the view of a cylinder
 * those behind the device, too. The hits are not exact yet: mesh_distance() decides where a ray hits a triangle. */
conus_status mesh_pass_pierce(struct mesh_pass *pass, const struct mesh_view *view, mesh_pass_take take, void *user);

#endif
