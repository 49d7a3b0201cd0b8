/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A triangulated surface in world space. */
#ifndef CONUS_ATLAS_SURFACE_MESH_H
#define CONUS_ATLAS_SURFACE_MESH_H

#include "base/notes.h"

#include <stdint.h>

/** The result of mesh_measure(). */
struct mesh_shape {
    double low[3], high[3]; /**< Bounds of the vertices that triangles use.                                  */
    double volume_mm3;      /**< Signed: positive where the triangles face outwards (divergence theorem).    */
    double centroid[3];     /**< That of the enclosed volume where closed, else of the surface.              */
    bool closed;            /**< mesh_is_closed(), triangles without area that were left out included.       */
    bool has_volume;        /**< Closed, and volume_mm3 is that of its inside: mesh_winds_once().            */
};

struct mesh {
    char *path;       /**< The file it came from; owned, NULL if none.                                 */
    float *positions; /**< [3 vertex_count] x, y, z in world mm (RAS); owned.                          */
    size_t vertex_count;
    uint32_t *triangles; /**< [3 triangle_count] vertex indices, counter-clockwise from outside; owned.   */
    size_t triangle_count;
    bool is_borrowed;        /**< The two arrays are not the mesh's own, not to be written, and 16 bytes behind each
                                  may be read.                                                                  */
    struct mesh_shape shape; /**< mesh_check() fills in `closed`, atlas_add_mesh() all of it. */
};

/** The corners of @p triangle. */
static inline void mesh_corners(double out[3][3], const struct mesh *mesh, size_t triangle)
{
    for (size_t k = 0; k < 3; k++) {
        const float *position = mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + k];
        for (int a = 0; a < 3; a++) {
            out[k][a] = (double)position[a];
        }
    }
}

void mesh_finish(struct mesh *mesh);

/** A mesh of zeroed arrays for so many vertices and triangles. */
conus_status mesh_init(struct mesh *out, size_t vertex_count, size_t triangle_count);

/** A copy of the vertices, triangles and shape. */
conus_status mesh_copy(struct mesh *out, const struct mesh *mesh);

/** Refuses meshes that no engine may get: no triangle, a coordinate that is not within 1e9 mm of 0, an index out of
 * range. Leaves out triangles without area and counts them in @p notes; notes a mesh that is not closed. */
conus_status mesh_check(struct mesh *mesh, struct notes *notes);

/** The part of mesh_check() that makes a mesh safe to use: numbers and indices. */
conus_status mesh_check_numbers(const struct mesh *mesh);

/** Measures a checked mesh; keeps mesh->shape.closed. CONUS_ERROR_MEMORY without memory for edges or crossings. */
conus_status mesh_measure(struct mesh_shape *out, const struct mesh *mesh);

/** Distance along a ray to the plane of @p triangle, clamped to the triangle's range along the ray: for a ray that hits
 * it, or misses it by less than rounding. In units of @p direction's length. */
double mesh_distance(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3]);

/** mesh_distance(), and in @p side where the ray comes from: 1 from the side that the triangle faces, -1 from the
 * other, 0 in the triangle's plane. */
double mesh_crossing(int *side, const struct mesh *mesh, size_t triangle, const double origin[3],
                     const double direction[3]);

/** Whether the line along a ray passes a triangle. Corners count by where they are: along each edge that two triangles
 * share the line passes one of them, and one of those round a corner, never none and never two (but where the surface
 * folds back). */
bool mesh_is_passed(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3]);

/** Moves every vertex by @p world_from_mesh; turns triangles around where that mirrors. */
void mesh_transform(struct mesh *mesh, const double world_from_mesh[16]);

#endif
