/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The edges at which a driver may differ from exact geometry: it moves the corners of triangles to a grid. */
#ifndef CONUS_TESTS_SUPPORT_GL_EDGE_H
#define CONUS_TESTS_SUPPORT_GL_EDGE_H

#include "atlas/surface/mesh.h"
#include "selection/cone/cone.h"

/** Whether the centre of @p pixel lies within 1/128 pixel of the projected edge of a triangle. */
bool gl_edge_is_near(const struct cone *cone, const struct mesh *mesh, uint64_t triangle, size_t pixel);

#endif
