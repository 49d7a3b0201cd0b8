/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where triangles cross the lines of a lattice that run along z. */
#ifndef CONUS_ATLAS_SURFACE_MESH_LINES_H
#define CONUS_ATLAS_SURFACE_MESH_LINES_H

#include "atlas/surface/mesh.h"

/** A place where a line passes through a triangle. */
struct line_crossing {
    size_t line;     /**< i + count[0] j                                                                        */
    uint32_t object; /**< The argument of mesh_lines_cross().                                                   */
    int32_t side;    /**< 1 where the line goes into what the triangle faces away from, -1 where it comes out. */
    double z;
};

/** Lines (i, j) at start + (i, j) step along x, y. The caller fills in the first three. */
struct mesh_lines {
    double start[2];
    double step[2]; /**< 0 = there is one place only, and no line. */
    size_t count[2];
    struct line_crossing *crossings; /**< Owned. */
    size_t crossing_count, capacity;
    size_t pairs; /**< Pairs of a line and a triangle whose bounds it passes, looked at so far. */
};

void mesh_lines_finish(struct mesh_lines *lines);

/** Appends the crossings of a triangle of @p mesh, whose vertices @p lines_from_mesh (NULL = the identity) moves. A
 * line that passes an edge or a corner counts as a little beside it, towards larger x and then larger y: of two
 * triangles on either side of an edge it passes one. So a closed surface is left as often as it is entered.
 * CONUS_ERROR_MEMORY. */
conus_status mesh_lines_cross(struct mesh_lines *lines, uint32_t object, const struct mesh *mesh, size_t triangle,
                              const double *lines_from_mesh);

/** Sorts the crossings by line, object, z. */
void mesh_lines_sort(struct mesh_lines *lines);

#endif
