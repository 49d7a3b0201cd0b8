/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the direction straight into a head, or to what is nearest of the atlas. */
#include "atlas/fit/fit.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/atlas.h"

#include <math.h>
#include <string.h>

static const double NEAR = 5; /* mm: how far from the point the head's surface counts */

/* Adds areas of triangles whose middles are near. */
static void add_surface(double sum[3], const struct mesh *mesh, const double point[3])
{
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double corner[3][3], way[3], area[3];
        mesh_corners(corner, mesh, i);
        for (int a = 0; a < 3; a++) {
            way[a] = (corner[0][a] + corner[1][a] + corner[2][a]) / 3 - point[a];
        }
        if (vec3_length(way) <= NEAR) {
            mesh_normal(area, mesh, i);
            vec3_add_scaled(sum, sum, mesh->shape.volume_mm3 < 0 ? -0.5 : 0.5, area);
        }
    }
}

/* Adds the faces between cells in the head and cells outside of it. */
static void add_head(double sum[3], const struct head *head, const double point[3])
{
    const struct volume *context = head->context;
    const double *m = context->info.world_from_voxel;
    const size_t stride[3] = {1, head->dim[0], head->dim[0] * head->dim[1]};
    double face[3][3]; /* outward where the head is on the lower side */
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        const int c = (a + 2) % 3;
        vec3_cross(face[a], m + 4 * b, m + 4 * c);
        vec3_scale(face[a], face[a], (double)(head->step[b] * head->step[c]) * (mat4_determinant3(m) < 0 ? -1 : 1));
    }
    for (size_t cell = 0; cell < head->dim[0] * head->dim[1] * head->dim[2]; cell++) {
        for (int a = 0; a < 3; a++) {
            if (cell / stride[a] % head->dim[a] + 1 == head->dim[a] ||
                head->inside[cell] == head->inside[cell + stride[a]]) {
                continue;
            }
            double at[3];
            for (int k = 0; k < 3; k++) {
                size_t index = cell / stride[k] % head->dim[k] * head->step[k];
                at[k] = (double)index + (double)(head->step[k] - 1) / 2 + (k == a ? (double)head->step[k] / 2 : 0);
            }
            mat4_point(at, m, at);
            vec3_sub(at, at, point);
            if (vec3_length(at) <= NEAR) {
                vec3_add_scaled(sum, sum, head->inside[cell] ? 1 : -1, face[a]);
            }
        }
    }
}

/* Points whose convex hull is that of all that is shown: the ends of each row of voxels, and vertices. */
struct corners {
    double (*points)[3];
    size_t count, capacity;
};

static conus_status add_corner(struct corners *corners, const double point[3])
{
    if (!memory_reserve(&corners->points, &corners->capacity, corners->count + 1, sizeof *corners->points)) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(corners->points[corners->count++], point, sizeof *corners->points);
    return CONUS_OK;
}

static conus_status add_rows(struct corners *corners, const struct volume *volume)
{
    const size_t width = volume->info.dim[0];
    conus_status status = CONUS_OK;
    for (size_t row = 0; row < volume->voxel_count && !status; row += width) {
        size_t ends[2] = {0, width};
        while (ends[0] < width && !volume_object(volume, row + ends[0])) {
            ends[0]++;
        }
        while (ends[1] > ends[0] && !volume_object(volume, row + ends[1] - 1)) {
            ends[1]--;
        }
        for (int end = 0; end < 2 && ends[0] < ends[1] && !status; end++) {
            const size_t line = row / width;
            const size_t row_at[2] = {line % volume->info.dim[1], line / volume->info.dim[1]};
            const double index[3] = {(double)(ends[end] - (size_t)end), (double)row_at[0], (double)row_at[1]};
            double at[3];
            mat4_point(at, volume->info.world_from_voxel, index);
            status = add_corner(corners, at);
        }
    }
    return status;
}

static conus_status find_corners(struct corners *corners, const conus_atlas *atlas)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        status = atlas_volume_has_areas(&atlas->volumes[i]) ? add_rows(corners, &atlas->volumes[i]) : CONUS_OK;
    }
    for (uint32_t number = 1; number <= atlas->object_count && !status; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        for (size_t i = 0; mesh && i < mesh->vertex_count && !status; i++) {
            const float *p = mesh->positions + 3 * i;
            status = add_corner(corners, (const double[]){(double)p[0], (double)p[1], (double)p[2]});
        }
    }
    return status;
}

/* The point nearest to 0 of the simplex of some of four points, if it lies between them all; else its square distance
 * is infinite. */
static double nearest_between(double out[3], const double (*points)[3], unsigned some)
{
    double from[3], edge[3][3], rows[3][4];
    int count = -1;
    for (int i = 0; i < 4; i++) {
        if (some >> i & 1) {
            if (count < 0) {
                memcpy(from, points[i], sizeof from);
            } else {
                vec3_sub(edge[count], points[i], from);
            }
            count++;
        }
    }
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) {
            rows[i][k] = vec3_dot(edge[i], edge[k]);
        }
        rows[i][count] = -vec3_dot(edge[i], from);
    }
    double rest = 1;
    for (int i = 0; i < count; i++) { /* Gauss and Jordan: the matrix is positive, unless edges are parallel */
        if (!(rows[i][i] > 0)) {
            return INFINITY;
        }
        for (int k = 0; k < count; k++) {
            double factor = k == i ? 0 : rows[k][i] / rows[i][i];
            for (int c = i; c <= count; c++) {
                rows[k][c] -= factor * rows[i][c];
            }
        }
    }
    memcpy(out, from, sizeof from);
    for (int i = 0; i < count; i++) {
        double part = rows[i][count] / rows[i][i];
        rest -= part;
        if (!(part >= 0)) {
            return INFINITY;
        }
        vec3_add_scaled(out, out, part, edge[i]);
    }
    return rest >= 0 ? vec3_dot(out, out) : INFINITY;
}

/* From a point to the nearest one of the hull (Gilbert, Johnson and Keerthi 1988); 0 inside of it. */
static void find_way(double out[3], const struct corners *corners, const double point[3])
{
    enum { STEPS = 200 };
    double simplex[4][3] = {{0}};
    size_t at[4] = {0};
    unsigned some = 1;
    vec3_sub(simplex[0], corners->points[0], point);
    memcpy(out, simplex[0], sizeof simplex[0]);
    for (int step = 0; step < STEPS && vec3_dot(out, out) > 0; step++) {
        double least = INFINITY;
        size_t best = 0;
        for (size_t i = 0; i < corners->count; i++) {
            double along = vec3_dot(out, corners->points[i]);
            best = along < least ? i : best;
            least = fmin(least, along);
        }
        const double gap = vec3_dot(out, out) - (least - vec3_dot(out, point));
        int place = 0;
        bool is_known = false;
        for (int i = 0; i < 4; i++) {
            is_known = is_known || ((some >> i & 1) && at[i] == best);
            place = some >> i & 1 ? place : i;
        }
        if (is_known || some == 15 || gap <= 1e-12 * vec3_dot(out, out)) {
            return;
        }
        at[place] = best;
        vec3_sub(simplex[place], corners->points[best], point);
        some |= 1U << place;
        double nearest = INFINITY;
        unsigned chosen = some;
        for (unsigned part = 1; part < 16; part++) {
            double foot[3];
            double square = (part & some) == part ? nearest_between(foot, (const double(*)[3])simplex, part) : INFINITY;
            if (square < nearest) {
                nearest = square;
                chosen = part;
                memcpy(out, foot, sizeof foot);
            }
        }
        some = chosen;
        if (some == 15) {
            memset(out, 0, 3 * sizeof *out);
        }
    }
}

static conus_status find_in_atlas(double out[3], const conus_atlas *atlas, const double point[3])
{
    struct corners corners = {0};
    double way[3] = {0};
    conus_status status = find_corners(&corners, atlas);
    if (!status && corners.count) {
        find_way(way, &corners, point);
    }
    if (!status && !vec3_normalise(way, way)) {
        status = fail(CONUS_ERROR_ARGUMENT, "(%.1f, %.1f, %.1f): %s, so that no way leads into it", point[0], point[1],
                      point[2], corners.count ? "it lies in the hull of the atlas" : "the atlas has no area");
    }
    memory_free(corners.points);
    if (!status) {
        memcpy(out, way, sizeof way);
    }
    return status;
}

conus_status conus_atlas_inward(double out[3], conus_inward *from, const conus_atlas *atlas, const double point[3])
{
    double sum[3] = {0};
    conus_inward found = CONUS_INWARD_SURFACE;
    conus_status status = !vec3_is_finite(point) ? fail(CONUS_ERROR_ARGUMENT, "inward: the point is not finite")
                          : atlas->lacks_context
                              ? fail(CONUS_ERROR_ARGUMENT, "inward: the atlas was loaded without its context, whose "
                                                           "head says where that is")
                              : CONUS_OK;
    for (size_t i = 0; i < atlas->context_surface_count && !status; i++) {
        const struct context_surface *surface = &atlas->context_surfaces[i];
        if (surface->mesh.shape.closed && !surface->is_shell) {
            add_surface(sum, &surface->mesh, point);
        }
    }
    if (!status && vec3_dot(sum, sum) == 0 && atlas_context(atlas)) {
        struct head head = {0};
        found = CONUS_INWARD_IMAGE;
        status = head_make(&head, atlas_context(atlas));
        if (!status) {
            add_head(sum, &head, point);
        }
        head_finish(&head);
    }
    if (status) {
        return status;
    }
    if (vec3_normalise(sum, sum)) {
        vec3_scale(out, sum, -1);
    } else {
        found = CONUS_INWARD_ATLAS;
        status = find_in_atlas(out, atlas, point);
    }
    if (!status && from) {
        *from = found;
    }
    return status;
}
