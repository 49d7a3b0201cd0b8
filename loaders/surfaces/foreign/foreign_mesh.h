/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the parsers of this folder fill: vertices as the file has them, in their order, and triangles. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_MESH_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_MESH_H

#include "atlas/surface/mesh.h"
#include "atlas/surface/mesh_space.h"
#include "base/text.h"

/** Cutting a polygon takes time that grows with the square of its corners. */
enum { POLYGON_LIMIT = 1024 };

/** Indices of vertices; owned. */
struct corners {
    uint32_t *indices;
    size_t count, capacity;
};

struct foreign_lines;

/** Zero is an empty one. */
struct foreign_mesh {
    float *positions; /**< [3 vertex_count], as stored; owned. */
    size_t vertex_count, vertex_capacity;
    uint32_t *triangles; /**< [3 triangle_count]; owned. */
    size_t triangle_count, triangle_capacity;
    struct corners face;         /**< The face that is being read. */
    size_t face_count;           /**< Faces and strips so far, of whatever size. */
    enum mesh_space space;       /**< That the file states. */
    struct foreign_lines *lines; /**< Of a VTK file; NULL: nobody wants them. Not owned. */
};

void foreign_mesh_finish(struct foreign_mesh *mesh);

/** Makes place for @p count vertices. CONUS_ERROR_DATA for more than 4294967295 of them. */
conus_status foreign_reserve_vertices(struct foreign_mesh *mesh, size_t count);

/** Appends a vertex. */
conus_status foreign_add_vertex(struct foreign_mesh *mesh, const float position[3]);

/** What messages call what is under way, number face_count. Lines come first where they are wanted. */
static inline const char *foreign_cell_word(const struct foreign_mesh *mesh)
{
    return mesh->lines ? "line or face" : "face";
}

/** Appends a corner to the face that is being read. CONUS_ERROR_DATA where @p index is no vertex yet. */
conus_status foreign_add_corner(struct foreign_mesh *mesh, int64_t index);

/** Ends the face as a polygon. One of two corners or one becomes a triangle without area, so that it is counted; of
 * none there is nothing. CONUS_ERROR_UNSUPPORTED above POLYGON_LIMIT corners. */
conus_status foreign_end_polygon(struct foreign_mesh *mesh);

/** Ends the face as a strip of triangles. */
conus_status foreign_end_strip(struct foreign_mesh *mesh);

/** Forgets the face: a line, or a point. */
void foreign_drop_face(struct foreign_mesh *mesh);

/** Appends a triangle of vertices that there are. */
conus_status foreign_add_triangle(struct foreign_mesh *mesh, uint32_t a, uint32_t b, uint32_t c);

/** Cuts a polygon of 4 corners or more into triangles and appends them (polygon.c). */
conus_status polygon_cut(struct foreign_mesh *mesh, const uint32_t *corners, size_t count);

/** Gives vertices and triangles to @p out, which is then the caller's to finish; not yet checked (mesh_check()). */
conus_status foreign_mesh_take(struct mesh *out, struct foreign_mesh *mesh);

#endif
