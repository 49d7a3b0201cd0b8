/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, checks, measures, moves and frees meshes, and tests a ray against a triangle. */
#include "atlas/surface/mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

#define COORDINATE_LIMIT 1e9F

void mesh_finish(struct mesh *mesh)
{
    memory_free(mesh->path);
    if (!mesh->is_borrowed) {
        memory_free(mesh->positions);
        memory_free(mesh->triangles);
    }
    *mesh = (struct mesh){0};
}

conus_status mesh_init(struct mesh *out, size_t vertex_count, size_t triangle_count)
{
    struct mesh mesh = {.vertex_count = vertex_count, .triangle_count = triangle_count};
    if (vertex_count > UINT32_MAX || triangle_count > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "%zu vertices and %zu triangles, allowed are 4294967295 of each", vertex_count,
                    triangle_count);
    }
    mesh.positions = memory_zeroed(vertex_count, 3 * sizeof *mesh.positions);
    mesh.triangles = memory_zeroed(triangle_count, 3 * sizeof *mesh.triangles);
    conus_status status = mesh.positions && mesh.triangles ? CONUS_OK : CONUS_ERROR_MEMORY;
    return GIVE(status, out, mesh, mesh_finish(&mesh));
}

conus_status mesh_copy(struct mesh *out, const struct mesh *mesh)
{
    conus_status status = mesh_init(out, mesh->vertex_count, mesh->triangle_count);
    if (!status) {
        memcpy(out->positions, mesh->positions, 3 * mesh->vertex_count * sizeof *mesh->positions);
        memcpy(out->triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *mesh->triangles);
        out->shape = mesh->shape;
    }
    return status;
}

void mesh_normal(double out[3], const struct mesh *mesh, size_t triangle)
{
    double p[3][3];
    mesh_corners(p, mesh, triangle);
    vec3_sub(p[1], p[1], p[0]);
    vec3_sub(p[2], p[2], p[0]);
    vec3_cross(out, p[1], p[2]);
}

conus_status mesh_check_numbers(const struct mesh *mesh)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        if (!(fabsf(mesh->positions[i]) <= COORDINATE_LIMIT)) {
            return fail(CONUS_ERROR_DATA, "vertex %zu: a coordinate is %g mm, allowed is -1e9 to 1e9", i / 3,
                        (double)mesh->positions[i]);
        }
    }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        if (mesh->triangles[i] >= mesh->vertex_count) {
            return fail(CONUS_ERROR_DATA, "triangle %zu: vertex index %u, allowed are 0 to %zu", i / 3,
                        mesh->triangles[i], mesh->vertex_count - 1);
        }
    }
    return CONUS_OK;
}

static size_t drop_flat_triangles(struct mesh *mesh)
{
    size_t kept = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double normal[3];
        mesh_normal(normal, mesh, i);
        if (vec3_length(normal) > 0) {
            for (size_t k = 0; k < 3; k++) {
                mesh->triangles[3 * kept + k] = mesh->triangles[3 * i + k];
            }
            kept++;
        }
    }
    size_t dropped = mesh->triangle_count - kept;
    mesh->triangle_count = kept;
    return dropped;
}

conus_status mesh_check(struct mesh *mesh, struct notes *notes)
{
    const char *path = mesh->path ? mesh->path : "mesh";
    conus_status status = mesh_check_numbers(mesh);
    status = status ? status : mesh_is_closed(&mesh->shape.closed, mesh);
    size_t flat = status ? 0 : drop_flat_triangles(mesh);
    if (!status && !mesh->triangle_count) {
        status = fail(CONUS_ERROR_DATA, "no triangle with an area: no ray can hit it");
    }
    if (!status && flat) {
        status = notes_add(notes, "%s: %zu triangles without area were left out", path, flat);
    }
    if (!status && !mesh->shape.closed) {
        status = notes_add(notes, "%s: the surface is not closed", path);
    }
    return status;
}

/* Volume and centroid as sums over tetrahedra from a point inside the bounds, so that far from the origin no digits
 * are lost; area and surface centroid beside them. */
static void integrate_triangles(struct mesh_shape *out, const struct mesh *mesh)
{
    double middle[3];
    double volume = 0;
    double area = 0;
    double moment[3] = {0};
    double surface[3] = {0};
    for (int a = 0; a < 3; a++) {
        middle[a] = (out->low[a] + out->high[a]) / 2;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double p[3][3];
        double normal[3];
        double sum[3] = {0};
        mesh_normal(normal, mesh, i);
        mesh_corners(p, mesh, i);
        for (int k = 0; k < 3; k++) {
            vec3_sub(p[k], p[k], middle);
            vec3_add_scaled(sum, sum, 1, p[k]);
        }
        double tetrahedron = vec3_dot(p[0], normal) / 6;
        volume += tetrahedron;
        area += vec3_length(normal) / 2;
        vec3_add_scaled(moment, moment, tetrahedron / 4, sum);
        vec3_add_scaled(surface, surface, vec3_length(normal) / 6, sum);
    }
    out->volume_mm3 = volume;
    bool solid = out->closed && fabs(volume) > 0;
    vec3_add_scaled(out->centroid, middle, 1 / (solid ? volume : area), solid ? moment : surface);
}

struct box3 mesh_box(const struct mesh *mesh)
{
    struct box3 box = box3_empty();
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double p[3][3];
        mesh_corners(p, mesh, i);
        for (int k = 0; k < 3; k++) {
            box3_add(&box, p[k]);
        }
    }
    return box;
}

conus_status mesh_measure(struct mesh_shape *out, const struct mesh *mesh)
{
    struct mesh_shape shape = {.closed = mesh->shape.closed};
    const struct box3 box = mesh_box(mesh);
    memcpy(shape.low, box.low, sizeof shape.low);
    memcpy(shape.high, box.high, sizeof shape.high);
    conus_status status = shape.closed ? CONUS_OK : mesh_is_closed(&shape.closed, mesh);
    if (status) {
        return status;
    }
    integrate_triangles(&shape, mesh);
    status = shape.closed ? mesh_winds_once(&shape.has_volume, mesh, &shape) : CONUS_OK;
    return GIVE(status, out, shape, 0);
}

double mesh_crossing(int *side, const struct mesh *mesh, size_t triangle, const double origin[3],
                     const double direction[3])
{
    double p[3][3], normal[3];
    double nearest = INFINITY;
    double farthest = -INFINITY;
    double per_length = 1 / vec3_dot(direction, direction);
    mesh_corners(p, mesh, triangle);
    for (int k = 0; k < 3; k++) {
        vec3_sub(p[k], p[k], origin);
        double reach = vec3_dot(p[k], direction) * per_length;
        nearest = nearest < reach ? nearest : reach; /* quicker than fmin() */
        farthest = farthest > reach ? farthest : reach;
    }
    vec3_sub(p[1], p[1], p[0]);
    vec3_sub(p[2], p[2], p[0]);
    vec3_cross(normal, p[1], p[2]);
    double slope = vec3_dot(normal, direction);
    double t = vec3_dot(normal, p[0]) / slope;
    *side = (slope < 0) - (slope > 0);
    t = t > nearest ? t : nearest; /* nearest, where the ray runs in the plane and t is no number */
    return t < farthest ? t : farthest;
}

/* A ray, seen along itself: corners of triangles are moved along it into the plane of the two axes that it follows
 * least. */
struct view {
    const double *origin;
    int axes[3];      /* The one that the ray follows most is the last. */
    double slopes[2]; /* of the ray along the other two axes, per mm of the last */
};

/* Whether a point, the origin, lies left of the way from a to b: exactly, by the errors of both products where these
 * are equal. On the line it is taken to lie a little aside along the first axis, and much less along the second. So of
 * the way from b to a it is always on the other side, and round a corner there is always one triangle that holds it. */
static bool is_left(const double a[2], const double b[2])
{
    double forth = a[0] * b[1];
    double back = a[1] * b[0];
    if (forth == back) {
        forth = fma(a[0], b[1], -forth);
        back = fma(a[1], b[0], -back);
    }
    if (forth != back) {
        return forth > back;
    }
    return a[1] != b[1] ? b[1] < a[1] : b[0] > a[0];
}

bool mesh_is_passed(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3])
{
    double corners[3][3];
    double p[3][2];
    int most = fabs(direction[1]) > fabs(direction[0]) ? 1 : 0;
    most = fabs(direction[2]) > fabs(direction[most]) ? 2 : most;
    struct view view = {.origin = origin, .axes = {(most + 1) % 3, (most + 2) % 3, most}};
    for (int i = 0; i < 2; i++) {
        view.slopes[i] = direction[view.axes[i]] / direction[most];
    }
    mesh_corners(corners, mesh, triangle);
    for (int k = 0; k < 3; k++) {
        double offset[3];
        vec3_sub(offset, corners[k], view.origin);
        for (int a = 0; a < 2; a++) {
            p[k][a] = offset[view.axes[a]] - view.slopes[a] * offset[view.axes[2]];
        }
    }
    bool left = is_left(p[0], p[1]);
    return is_left(p[1], p[2]) == left && is_left(p[2], p[0]) == left;
}

double mesh_distance(const struct mesh *mesh, size_t triangle, const double origin[3], const double direction[3])
{
    int side;
    return mesh_crossing(&side, mesh, triangle, origin, direction);
}

void mesh_turn(struct mesh *mesh)
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        uint32_t *t = &mesh->triangles[3 * i];
        uint32_t kept = t[1];
        t[1] = t[2];
        t[2] = kept;
    }
}

void mesh_transform(struct mesh *mesh, const double world_from_mesh[16])
{
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = &mesh->positions[3 * i];
        double moved[3] = {(double)p[0], (double)p[1], (double)p[2]};
        mat4_point(moved, world_from_mesh, moved);
        for (int a = 0; a < 3; a++) {
            p[a] = (float)moved[a];
        }
    }
    if (mat4_determinant3(world_from_mesh) < 0) {
        mesh_turn(mesh);
    }
}
