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

/** Whether the closed @p mesh winds once, everywhere in the same way, around what it encloses. It does not where two
 * parts overlap, or where one faces outwards and another inwards (a mirrored half, say): the signed volume then counts
 * some of the inside twice, or takes it away. Parts that face inwards are fine as cavities of others.
 *
 * Looked at along 64 x 64 lines through the bounds of @p shape. They may disagree on a hundredth of the inside, as
 * surfaces with small folds do. Also false for a mesh with more than 2^26 pairs of a line and a triangle near it. */
conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape);

#endif
