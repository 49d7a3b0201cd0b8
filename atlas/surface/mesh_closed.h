/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether a mesh bounds a solid. */
#ifndef CONUS_ATLAS_SURFACE_MESH_CLOSED_H
#define CONUS_ATLAS_SURFACE_MESH_CLOSED_H

#include "atlas/surface/mesh.h"

/** Whether triangles pass every edge as often in one direction as in the other. Vertices at equal positions are one,
 * and triangles without area count: leave none out before. Then the surface winds a whole number of times around every
 * point that is not on it. */
conus_status mesh_is_closed(bool *out, const struct mesh *mesh);

/** first[v], of each vertex v of @p mesh: the first vertex at the same position; -0 is 0. Only the vertices of @p mesh
 * are looked at. */
conus_status mesh_find_first(uint32_t *first, const struct mesh *mesh);

#endif
