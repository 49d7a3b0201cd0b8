/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether the signed volume of a closed mesh is that of its inside. */
#ifndef CONUS_ATLAS_SURFACE_MESH_WINDING_H
#define CONUS_ATLAS_SURFACE_MESH_WINDING_H

#include "atlas/surface/mesh.h"

/** Whether the closed @p mesh winds once, everywhere in the same way, around what it encloses. It does not where two
 * parts overlap, or where one faces outwards and another inwards (a mirrored half, say): the signed volume then counts
 * some of the inside twice, or takes it away. Parts that face inwards are fine as cavities of others.
 *
 * Looked at along 64 x 64 lines through the bounds of @p shape. They may disagree on a hundredth of the inside, as
 * surfaces with small folds do. Also false for a mesh with more than 2^26 pairs of a line and a triangle near it. */
conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape);

#endif
