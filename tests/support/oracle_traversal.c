/* SPDX-License-Identifier: BSD-3-Clause */
/* Amanatides and Woo, one voxel at a time. */
#include "oracle_traversal.h"

#include "base/geometry/math3.h"

#include <math.h>

static const struct oracle_hit nothing = {.distance = INFINITY, .voxel = EVIDENCE_NO_VOXEL};

/* A ray on its way; t_next[a] is when it leaves its cell along axis a. */
struct walk {
    double origin[3], inverse[3];
    long cell[3], step[3], dim[3];
    double t, t_next[3];
    double face[3]; /* the plane crossed at t_next */
};

static long cell_holding(double x)
{
    long cell = lround(floor(x));
    return x - (double)cell >= 0.5 ? cell + 1 : cell;
}

/* The face through which the ray comes into `cell` along axis a. */
static double face_before(const struct walk *walk, int a, long cell)
{
    return (double)(walk->step[a] > 0 ? cell : cell + 1) - 0.5;
}

static double entry(const struct walk *walk, int a, long cell)
{
    return (face_before(walk, a, cell) - walk->origin[a]) * walk->inverse[a];
}

/* Puts the walk at its start or, from outside, at the crossing with which it enters the grid along the last axis. */
static bool start_walk(struct walk *walk)
{
    int last = -1;
    for (int a = 0; a < 3; a++) {
        long face = walk->step[a] > 0 ? 0 : walk->dim[a] - 1;
        bool before = walk->step[a] > 0 ? walk->cell[a] < 0 : walk->step[a] < 0 && walk->cell[a] >= walk->dim[a];
        if (before) {
            double t = entry(walk, a, face);
            if (t >= walk->t) {
                walk->t = t;
                last = a;
            }
            walk->cell[a] = face;
        }
    }
    for (int a = 0; a < 3 && last >= 0; a++) {
        for (; a != last && walk->step[a] && walk->cell[a] >= 0 && walk->cell[a] < walk->dim[a];
             walk->cell[a] += walk->step[a]) {
            double t = entry(walk, a, walk->cell[a] + walk->step[a]);
            if (t > walk->t || (t == walk->t && a > last)) {
                break;
            }
        }
    }
    for (int a = 0; a < 3; a++) {
        walk->face[a] = face_before(walk, a, walk->cell[a] + walk->step[a]);
        walk->t_next[a] = walk->step[a] ? entry(walk, a, walk->cell[a] + walk->step[a]) : INFINITY;
        if (walk->cell[a] < 0 || walk->cell[a] >= walk->dim[a]) {
            return false;
        }
    }
    return true;
}

/* Crosses the next face of axis a; false when that leaves the grid. */
static inline bool step_along(struct walk *walk, int a)
{
    walk->t = walk->t_next[a];
    walk->cell[a] += walk->step[a];
    walk->face[a] += (double)walk->step[a];
    walk->t_next[a] = (walk->face[a] - walk->origin[a]) * walk->inverse[a];
    return walk->cell[a] >= 0 && walk->cell[a] < walk->dim[a] && walk->step[a];
}

static struct oracle_hit follow(const struct volume *volume, const struct walk *start_of_walk)
{
    struct walk walk = *start_of_walk;
    long row = walk.dim[0];
    long layer = walk.dim[0] * walk.dim[1];
    bool inside = true;
    while (inside) {
        size_t voxel = (size_t)(walk.cell[0] + row * walk.cell[1] + layer * walk.cell[2]);
        uint32_t object = volume_object(volume, voxel);
        if (object) {
            return (struct oracle_hit){.object = object, .distance = walk.t, .voxel = voxel};
        }
        if (walk.t_next[0] <= walk.t_next[1] && walk.t_next[0] <= walk.t_next[2]) {
            inside = step_along(&walk, 0);
        } else if (walk.t_next[1] <= walk.t_next[2]) {
            inside = step_along(&walk, 1);
        } else {
            inside = step_along(&walk, 2);
        }
    }
    return nothing;
}

struct oracle_hit oracle_ray(const struct volume *volume, const double origin[3], const double direction[3])
{
    struct walk walk = {.origin = {origin[0], origin[1], origin[2]}};
    for (int a = 0; a < 3; a++) {
        walk.dim[a] = (long)volume->info.dim[a];
        walk.cell[a] = cell_holding(origin[a]);
        walk.inverse[a] = 1 / direction[a];
        walk.step[a] = fabs(direction[a]) < 0x1p-900 ? 0 : direction[a] > 0 ? 1 : -1; /* Eq. 5 */
    }
    if (!start_walk(&walk)) {
        return nothing;
    }
    return follow(volume, &walk);
}

/* The first hit of one ray in one volume, kept if it is nearer than the hit so far. */
static void trace_ray(struct evidence *out, size_t pixel, const struct volume *volume, const double origin[3],
                      const double direction[3])
{
    struct oracle_hit hit = oracle_ray(volume, origin, direction);
    if (hit.object && (hit.distance < out->distance[pixel] ||
                       (hit.distance == out->distance[pixel] && hit.object < out->object[pixel]))) {
        out->object[pixel] = hit.object;
        out->distance[pixel] = hit.distance;
        out->voxel[pixel] = hit.voxel;
    }
}

enum { ROW_LIMIT = 1024 };

static void trace_row(struct evidence *out, const struct volume *volume, const struct cone *cone, uint32_t j)
{
    double u[ROW_LIMIT], v[ROW_LIMIT], x[ROW_LIMIT], y[ROW_LIMIT], z[ROW_LIMIT];
    double *const directions[3] = {x, y, z};
    double origin[3];
    uint32_t n = cone->resolution;
    for (uint32_t i = 0; i < n; i++) {
        u[i] = cone_coordinate(i, n);
        v[i] = cone_coordinate(j, n);
    }
    cone_rays(directions, cone, u, v, n);
    mat4_point(origin, volume->voxel_from_world, cone->pose.world_from_device + 12);
    for (uint32_t i = 0; i < n; i++) {
        double direction[3] = {x[i], y[i], z[i]};
        mat4_direction(direction, volume->voxel_from_world, direction);
        trace_ray(out, (size_t)j * n + i, volume, origin, direction);
    }
}

void oracle_trace(struct evidence *out, const conus_atlas *atlas, const struct cone *cone)
{
    evidence_clear(out);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        for (uint32_t j = 0; j < cone->resolution && atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT; j++) {
            trace_row(out, &atlas->volumes[i], cone, j);
        }
    }
}
