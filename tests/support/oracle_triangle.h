/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The oracle of Eq. 9: one ray and one triangle by Moeller and Trumbore in double. conus-bench uses it, too. */
#ifndef CONUS_TESTS_SUPPORT_ORACLE_TRIANGLE_H
#define CONUS_TESTS_SUPPORT_ORACLE_TRIANGLE_H

#include "atlas/surface/mesh.h"

/** Corner @p k, 0 to 2, of a triangle. */
void oracle_corner(double out[3], const struct mesh *mesh, size_t triangle, size_t k);

/** The distance, in lengths of @p direction, at which the ray passes the triangle, both faces and edges included;
 * INFINITY if it misses. @p side becomes 1 or -1, by the face that the ray comes to. */
double oracle_triangle(int *side, const struct mesh *mesh, size_t triangle, const double origin[3],
                       const double direction[3]);

#endif
