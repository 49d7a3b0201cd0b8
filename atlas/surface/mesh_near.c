/* SPDX-License-Identifier: BSD-3-Clause */
/* Distance from a point or a needle to a mesh, and the winding number of the mesh around it. */
#include "atlas/surface/mesh.h"

#include "base/geometry/math3.h"

static void copy_corners(double out[3][3], const struct mesh *mesh, size_t triangle, const double origin[3])
{
    mesh_corners(out, mesh, triangle);
    for (int c = 0; c < 3; c++) {
        vec3_sub(out[c], out[c], origin);
    }
}

/* Whether the origin is above the triangle's inside, and its foot there. */
static bool foot_inside(double out[3], double corner[3][3])
{
    double ab[3];
    double ac[3];
    double normal[3];
    vec3_sub(ab, corner[1], corner[0]);
    vec3_sub(ac, corner[2], corner[0]);
    vec3_cross(normal, ab, ac);
    double square = vec3_dot(normal, normal);
    if (!(square > 0)) {
        return false;
    }
    vec3_scale(out, normal, vec3_dot(corner[0], normal) / square);
    for (int c = 0; c < 3; c++) {
        double edge[3];
        double to_foot[3];
        double side[3];
        vec3_sub(edge, corner[(c + 1) % 3], corner[c]);
        vec3_sub(to_foot, out, corner[c]);
        vec3_cross(side, edge, to_foot);
        if (vec3_dot(side, normal) < 0) {
            return false;
        }
    }
    return true;
}

static double nearest_on_triangle(double out[3], double corner[3][3])
{
    if (foot_inside(out, corner)) {
        return vec3_length(out);
    }
    double best = INFINITY;
    for (int c = 0; c < 3; c++) {
        double point[3];
        double along[3];
        vec3_sub(along, corner[(c + 1) % 3], corner[c]);
        double length2 = vec3_dot(along, along);
        double t = length2 > 0 ? -vec3_dot(corner[c], along) / length2 : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        vec3_add_scaled(point, corner[c], t, along);
        double distance = vec3_length(point);
        if (distance < best) {
            best = distance;
            memcpy(out, point, sizeof point);
        }
    }
    return best;
}

/* A lower bound for the distance of a triangle from the origin: that of its bounding box. */
static double box_distance(double corner[3][3])
{
    double gap[3];
    for (int a = 0; a < 3; a++) {
        double low = fmin(corner[0][a], fmin(corner[1][a], corner[2][a]));
        double high = fmax(corner[0][a], fmax(corner[1][a], corner[2][a]));
        gap[a] = low > 0 ? low : high < 0 ? high : 0;
    }
    return vec3_length(gap);
}

double mesh_nearest(double out[3], const struct mesh *mesh, const double point[3], double limit)
{
    double best = INFINITY;
    for (size_t triangle = 0; triangle < mesh->triangle_count; triangle++) {
        double corner[3][3];
        double foot[3] = {0};
        copy_corners(corner, mesh, triangle, point);
        if (box_distance(corner) > fmin(limit, best)) {
            continue;
        }
        double distance = nearest_on_triangle(foot, corner);
        if (distance < best && distance <= limit) {
            best = distance;
            vec3_add_scaled(out, point, 1, foot);
        }
    }
    return best;
}

double mesh_needle(double *depth, double point[3], const struct mesh *mesh, size_t triangle,
                   const struct needle *needle)
{
    double corner[3][3];
    double best = INFINITY;
    if (mesh_is_passed(mesh, triangle, needle->origin, needle->direction)) {
        double t = mesh_distance(mesh, triangle, needle->origin, needle->direction);
        if (t >= needle->near && t <= needle->far) {
            *depth = t;
            needle_point(point, needle, t);
            return 0;
        }
    }
    /* Else it is nearest to an edge, or with an end above the inside */
    mesh_corners(corner, mesh, triangle);
    for (int c = 0; c < 3; c++) {
        double foot[3];
        double t;
        double distance = needle_segment(&t, foot, needle, corner[c], corner[(c + 1) % 3]);
        if (distance < best || (distance == best && t < *depth)) {
            best = distance;
            *depth = t;
            memcpy(point, foot, sizeof foot);
        }
    }
    for (int end = 0; end < 2; end++) {
        double t = end ? needle->far : needle->near;
        double tip[3];
        double foot[3];
        needle_point(tip, needle, t);
        copy_corners(corner, mesh, triangle, tip);
        if (foot_inside(foot, corner)) {
            double distance = vec3_length(foot);
            if (distance < best || (distance == best && t < *depth)) {
                best = distance;
                *depth = t;
                vec3_add_scaled(point, tip, 1, foot);
            }
        }
    }
    return best;
}

double mesh_winding(const struct mesh *mesh, const double point[3])
{
    double sum = 0;
    for (size_t triangle = 0; triangle < mesh->triangle_count; triangle++) {
        double corner[3][3];
        double normal[3];
        copy_corners(corner, mesh, triangle, point);
        double a = vec3_length(corner[0]);
        double b = vec3_length(corner[1]);
        double c = vec3_length(corner[2]);
        vec3_cross(normal, corner[1], corner[2]);
        sum += atan2(vec3_dot(corner[0], normal), a * b * c + vec3_dot(corner[0], corner[1]) * c +
                                                      vec3_dot(corner[1], corner[2]) * a +
                                                      vec3_dot(corner[2], corner[0]) * b);
    }
    return sum / (2 * MATH3_PI);
}
