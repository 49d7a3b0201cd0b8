/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How far a point is from a surface, and whether the surface is around it. */
#ifndef CONUS_ATLAS_SURFACE_MESH_NEAR_H
#define CONUS_ATLAS_SURFACE_MESH_NEAR_H

#include "atlas/surface/mesh.h"
#include "base/geometry/needle.h"

/** Distance from @p point to the nearest point of any triangle, which @p out receives; INFINITY (and @p out untouched)
 * where that is more than @p limit. */
double mesh_nearest(double out[3], const struct mesh *mesh, const double point[3], double limit);

/** Distance from @p needle to @p triangle, 0 where it passes it (mesh_is_passed()). @p depth receives the least depth
 * at which it is so near, @p point the triangle's nearest point there. */
double mesh_needle(double *depth, double point[3], const struct mesh *mesh, size_t triangle,
                   const struct needle *needle);

/** How often the surface winds around @p point: 1 inside of a closed surface and 0 outside, between them near a hole in
 * one; negative where its triangles face inwards. The sum of the triangles' solid angles over 4 pi (van Oosterom and
 * Strackee 1983). */
double mesh_winding(const struct mesh *mesh, const double point[3]);

#endif
