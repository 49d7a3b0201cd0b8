/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The mesh that the parsers of this folder fill: vertices in the file's order, and triangles. VTK's files also
 * have lines of any number of corners, and numbers of points and cells; a reader that wants them points
 * foreign_mesh.lines to a struct foreign_lines. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_MESH_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_MESH_H

#include "atlas/surface/mesh.h"
#include "atlas/surface/mesh_space.h"
#include "base/notes.h"
#include "base/text.h"

enum {
    POLYGON_LIMIT = 1024, /**< Corners: cutting a polygon takes time that grows with their square. */
    FOREIGN_ARRAY_LIMIT = 4096,
    FOREIGN_COMPONENT_LIMIT = 65536
};

/** Indices of vertices; owned. */
struct corners {
    uint32_t *indices;
    size_t count, capacity;
};

/** A named array of numbers, for all points or all lines. */
struct foreign_array {
    char *name; /**< UTF-8; owned. */
    bool per_point;
    uint32_t components;
    float *values; /**< [count], rounded once; owned. */
    size_t count, capacity;
};

/** An empty one is zero, except max_memory. */
struct foreign_lines {
    struct corners corners; /**< Vertex indices of all lines, line after line. */
    size_t *ends;           /**< [count] Index after the last corner of each line; owned. */
    size_t count, capacity;
    size_t before; /**< Cells that VTK numbers before lines: single vertices. */
    size_t behind; /**< Cells that VTK numbers after lines: polygons and strips. */
    struct foreign_array *arrays;
    size_t array_count, array_capacity;
    uint64_t max_memory; /**< Bytes that values of arrays may still take. */
};

/** Zero is an empty one. */
struct foreign_mesh {
    float *positions; /**< [3 vertex_count], as stored; owned. */
    size_t vertex_count, vertex_capacity;
    uint32_t *triangles; /**< [3 triangle_count]; owned. */
    size_t triangle_count, triangle_capacity;
    struct corners face;         /**< The face that is being read. */
    size_t face_count;           /**< Faces and strips so far, of whatever size. */
    enum mesh_space space;       /**< The space that the file states. */
    struct foreign_lines *lines; /**< Lines of a VTK file, not owned; NULL: lines are skipped. */
    struct notes notes;          /**< What was passed over. */
};

void foreign_mesh_finish(struct foreign_mesh *mesh);
void foreign_lines_finish(struct foreign_lines *lines);

/** Makes place for @p count vertices. CONUS_ERROR_DATA for more than 4294967295 of them. */
conus_status foreign_reserve_vertices(struct foreign_mesh *mesh, size_t count);

/** Appends a vertex. */
conus_status foreign_add_vertex(struct foreign_mesh *mesh, const float position[3]);

/** The word of messages for the cell under way, number face_count. Lines come first where they are wanted. */
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

/** Ends the face as a line; passes it over where nobody wants lines. */
conus_status foreign_end_line(struct foreign_mesh *mesh);

/** Appends a triangle; its vertices must be there. */
conus_status foreign_add_triangle(struct foreign_mesh *mesh, uint32_t a, uint32_t b, uint32_t c);

/** Gives vertices and triangles to @p out, which is then the caller's to finish; not yet checked (mesh_check()). */
conus_status foreign_mesh_take(struct mesh *out, struct foreign_mesh *mesh);

/** The array @p name, which is added where there is none. CONUS_ERROR_DATA for one with other components, for too many
 * of them, and for more than FOREIGN_ARRAY_LIMIT arrays. */
conus_status foreign_lines_array(struct foreign_array **out, struct foreign_lines *lines, struct text name,
                                 bool per_point, uint64_t components);

/** Makes place for @p more values of @p array, one of @p lines. CONUS_ERROR_MEMORY above max_memory. */
conus_status foreign_array_reserve(struct foreign_lines *lines, struct foreign_array *array, size_t more);

/** The value behind "SPACE" in @p text: 3D Slicer writes "SPACE=RAS" or "SPACE=LPS". */
enum mesh_space foreign_space_in(struct text text);

/** The objects of an OBJ that have faces, in the order in which they come first. */
struct obj_objects {
    struct text *names; /**< [count] Inside the file's bytes; "" for what is in none. Owned. */
    uint32_t *owners;   /**< [triangle_count] The object of each triangle; owned.             */
    size_t count;
};

void obj_objects_finish(struct obj_objects *objects);

/* Each parser takes the whole file, unpacked, and fills @p out, which is empty and the caller's to finish, also after a
 * failure. CONUS_ERROR_DATA for a file that contradicts itself or is cut off, CONUS_ERROR_UNSUPPORTED for a valid one
 * that is not read. All vertices come in the file's order, triangles in that of the faces; positions as stored. */

/** Wavefront OBJ. @p objects may be NULL; statements "o" of the same name are one object. */
conus_status obj_parse(struct foreign_mesh *out, struct obj_objects *objects, const uint8_t *data, size_t size);

/** PLY, ASCII or binary of either byte order. */
conus_status ply_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** STL, ASCII or binary. Corners at equal positions are one vertex, the first of them. */
conus_status stl_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** OFF, COFF, NOFF, STOFF and their mixtures, as text. */
conus_status off_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** MZ3 (Surf Ice, NiiVue), unpacked. */
conus_status mz3_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** Legacy VTK, POLYDATA, to version 5.1. */
conus_status vtk_parse(struct foreign_mesh *out, const uint8_t *data, size_t size);

/** VTP. An array may have @p limit bytes, unpacked. */
conus_status vtp_parse(struct foreign_mesh *out, const uint8_t *data, size_t size, uint64_t limit);

#endif
