/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_traversal.h"

#include "base/math3.h"

#include <math.h>

/* A ray on its way; t_next[a] is when it leaves its cell along axis a. */
struct walk {
    const double *origin;
    double inverse[3];
    long cell[3], step[3], dim[3];
    double t, t_next[3];
};

static long cell_holding(double x)
{
    long cell = lround(floor(x));
    return x - (double)cell >= 0.5 ? cell + 1 : cell;
}

/* When the ray crosses into `cell` along axis a from the cell before it. */
static double entry(const struct walk *walk, int a, long cell)
{
    long plane = walk->step[a] > 0 ? cell : cell + 1;
    return ((double)plane - 0.5 - walk->origin[a]) * walk->inverse[a];
}

/* Puts the walk on its start or, from outside, on the crossing that brings the last of the axes into the grid. */
static bool start(struct walk *walk)
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
        walk->t_next[a] = walk->step[a] ? entry(walk, a, walk->cell[a] + walk->step[a]) : INFINITY;
        if (walk->cell[a] < 0 || walk->cell[a] >= walk->dim[a]) {
            return false;
        }
    }
    return true;
}

struct oracle_hit oracle_ray(const struct volume *volume, const double origin[3], const double direction[3])
{
    const struct oracle_hit none = {.distance = INFINITY, .voxel = EVIDENCE_NO_VOXEL};
    struct walk walk = {.origin = origin};
    for (int a = 0; a < 3; a++) {
        walk.dim[a] = (long)volume->info.dim[a];
        walk.cell[a] = cell_holding(origin[a]);
        walk.inverse[a] = 1 / direction[a];
        walk.step[a] = isinf(walk.inverse[a]) ? 0 : direction[a] > 0 ? 1 : -1;
    }
    if (!start(&walk)) {
        return none;
    }
    const long stride[3] = {1, walk.dim[0], walk.dim[0] * walk.dim[1]};
    long voxel = walk.cell[0] + stride[1] * walk.cell[1] + stride[2] * walk.cell[2];
    for (;;) {
        uint32_t object = volume_object(volume, (size_t)voxel);
        if (object) {
            return (struct oracle_hit){.object = object, .distance = walk.t, .voxel = (uint64_t)voxel};
        }
        int a = walk.t_next[1] < walk.t_next[0] ? 1 : 0;
        a = walk.t_next[2] < walk.t_next[a] ? 2 : a;
        walk.cell[a] += walk.step[a];
        if (walk.cell[a] < 0 || walk.cell[a] >= walk.dim[a] || !walk.step[a]) {
            return none;
        }
        walk.t = walk.t_next[a];
        walk.t_next[a] = entry(&walk, a, walk.cell[a] + walk.step[a]);
        voxel += walk.step[a] * stride[a];
    }
}

static void look_at(struct evidence *out, const struct volume *volume, const struct cone *cone)
{
    double origin[3];
    mat4_point(origin, volume->voxel_from_world, cone->pose.world_from_device + 12);
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        double direction[3];
        cone_ray(direction, cone, pixel % cone->resolution, pixel / cone->resolution);
        mat4_direction(direction, volume->voxel_from_world, direction);
        struct oracle_hit hit = oracle_ray(volume, origin, direction);
        if (hit.object && (hit.distance < out->distance[pixel] ||
                           (hit.distance == out->distance[pixel] && hit.object < out->object[pixel]))) {
            out->object[pixel] = hit.object;
            out->distance[pixel] = hit.distance;
            out->voxel[pixel] = hit.voxel;
        }
    }
}

void oracle_look(struct evidence *out, const conus_atlas *atlas, const struct cone *cone)
{
    evidence_clear(out);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_CONTEXT) {
            look_at(out, &atlas->volumes[i], cone);
        }
    }
}
