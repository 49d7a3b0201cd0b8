/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A sink that makes triangles of polygons and strips, and passes over lines and points. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_MESH_BUILD_H
#define CONUS_LOADERS_SURFACES_FOREIGN_MESH_BUILD_H

#include "atlas/surface/mesh.h"
#include "loaders/surfaces/foreign/mesh_sink.h"

enum { POLYGON_LIMIT = 1024 }; /**< Corners: cutting a polygon takes time that grows with their square. */

struct mesh_triangle {
    uint32_t corners[3];
};

struct mesh_build {
    struct mesh_sink sink; /**< The first member. */
    LIST(struct mesh_triangle) triangles;
    LIST(uint32_t) owners; /**< For each triangle its place in sink.objects, if there are any. */
    struct polygon *polygon;
};

/** An empty one, which the parsers get as mesh_build.sink. A polygon of two corners or one becomes a triangle without
 * area, so that it is counted; of none there is nothing. One of more than POLYGON_LIMIT corners is
 * CONUS_ERROR_UNSUPPORTED. Every second triangle of a strip is turned around. */
struct mesh_build mesh_build_of(struct job *job);

/** Appends a triangle; its vertices must be there. */
void mesh_build_triangle(struct mesh_build *build, uint32_t a, uint32_t b, uint32_t c);

/** Gives vertices and triangles to @p out, which is empty and the caller's to finish; not yet checked (mesh_check()).
 * A failure where there are no triangles. */
void mesh_build_give(struct mesh *out, struct mesh_build *build);

/** The objects that have triangles, in the order in which they come first. */
struct mesh_objects {
    struct text *names; /**< [count] "" for what is in none. In the file's bytes. */
    size_t count;
};

/** Finds them, and makes @p build's owners their numbers. Objects of one name are one. */
struct mesh_objects mesh_build_objects(struct mesh_build *build);

#endif
