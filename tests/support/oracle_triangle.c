/* SPDX-License-Identifier: BSD-3-Clause */
/* Moeller and Trumbore, one triangle at a time. */
#include "oracle_triangle.h"

#include "base/geometry/math3.h"

void oracle_corner(double out[3], const struct mesh *mesh, size_t triangle, size_t k)
{
    const float *p = &mesh->positions[3 * (size_t)mesh->triangles[3 * triangle + k]];
    out[0] = (double)p[0], out[1] = (double)p[1], out[2] = (double)p[2];
}

double oracle_triangle(int *side, const struct mesh *mesh, size_t triangle, const double origin[3],
                       const double direction[3])
{
    double p[3][3], across[3], from[3], turned[3];
    for (size_t k = 0; k < 3; k++) {
        oracle_corner(p[k], mesh, triangle, k);
    }
    vec3_sub(p[1], p[1], p[0]);
    vec3_sub(p[2], p[2], p[0]);
    vec3_cross(across, direction, p[2]);
    vec3_sub(from, origin, p[0]);
    vec3_cross(turned, from, p[1]);
    double scale = 1 / vec3_dot(p[1], across);
    double u = vec3_dot(from, across) * scale, v = vec3_dot(direction, turned) * scale;
    double t = vec3_dot(p[2], turned) * scale;
    *side = (scale > 0) - (scale < 0);
    return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 ? t : INFINITY;
}
