/* SPDX-License-Identifier: BSD-3-Clause */
/* Projects triangles and measures the distance of a pixel to their edges. */
#include "gl_edge.h"

#include "base/geometry/math3.h"

/* Pixels by which a driver's vertex grid may move an edge. */
#define EDGE_PIXELS (1 / 128.0)

/* Corner `k` of a triangle in the buffer's pixels, times its depth, and the depth: homogeneous coordinates; of a
 * cylinder 1 for the depth. */
static void project_corner(double out[3], const struct cone *cone, const struct mesh *mesh, uint64_t triangle, int k)
{
    const double *m = cone->pose.world_from_device;
    const float *p = &mesh->positions[3 * (size_t)mesh->triangles[3 * triangle + (uint64_t)k]];
    double v[3];
    for (int a = 0; a < 3; a++) {
        v[a] = (double)p[a] - m[12 + a];
    }
    bool parallel = cone->radius > 0;
    double width = parallel ? cone->radius : tan(cone->angle / 2);
    double n = cone->resolution;
    out[2] = parallel ? 1 : -vec3_dot(m + 8, v);
    out[0] = (vec3_dot(m, v) / width + out[2]) * n / 2;
    out[1] = (vec3_dot(m + 4, v) / width + out[2]) * n / 2;
}

/* Clips the edge at the eye's plane; false if nothing is left. */
static bool clip_edge(double a[3], double b[3])
{
    double least = 1e-9 * fmax(fabs(a[2]), fabs(b[2]));
    if (a[2] < least && b[2] < least) {
        return false;
    }
    double *behind = a[2] < b[2] ? a : b;
    const double *before = a[2] < b[2] ? b : a;
    if (behind[2] < least) {
        double s = (least - behind[2]) / (before[2] - behind[2]);
        for (int k = 0; k < 3; k++) {
            behind[k] += s * (before[k] - behind[k]);
        }
    }
    return true;
}

/* Pixels from (x, y) to the projection of the edge. */
static double edge_distance(double a[3], double b[3], double x, double y)
{
    if (!clip_edge(a, b)) {
        return INFINITY;
    }
    const double from[2] = {a[0] / a[2] - x, a[1] / a[2] - y};
    const double along[2] = {b[0] / b[2] - x - from[0], b[1] / b[2] - y - from[1]};
    double length = hypot(along[0], along[1]);
    double across = length > 0 ? fabs(from[0] * along[1] - from[1] * along[0]) / length : hypot(from[0], from[1]);
    double part = length > 0 ? -(from[0] * along[0] + from[1] * along[1]) / length : 0;
    double beyond = fmax(fmax(-part, part - length), 0);
    return hypot(across, beyond);
}

bool gl_edge_is_near(const struct cone *cone, const struct mesh *mesh, uint64_t triangle, size_t pixel)
{
    size_t column = pixel % cone->resolution;
    size_t row = pixel / cone->resolution;
    double x = (double)column + 0.5;
    double y = (double)row + 0.5;
    for (int k = 0; k < 3; k++) {
        double a[3], b[3];
        project_corner(a, cone, mesh, triangle, k);
        project_corner(b, cone, mesh, triangle, (k + 1) % 3);
        if (edge_distance(a, b, x, y) <= EDGE_PIXELS) {
            return true;
        }
    }
    return false;
}
