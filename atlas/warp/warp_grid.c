/* SPDX-License-Identifier: BSD-3-Clause */
/* The voxels of a warped atlas, where nobody names a grid. */
#include "atlas/space.h"
#include "atlas/warp/warp.h"
#include "base/geometry/math3.h"

#include <string.h>

/* Numbers of voxels: up to PLAIN a grid is whole; beyond both MOST and MOST_TIMES those of the atlas it is
 * refused. */
#define PLAIN 16777216.0
#define MOST 134217728.0
#define MOST_TIMES 16
#define NONE_MADE 1e15 /* the same for an atlas without voxels, of which none are made */

/* Whatever the field leads into `box` comes from the result, in the field's indices: a point q goes to base q + w,
 * where w is in the box of the vectors, since the weights of a spline, or between nodes, are 0 or more and sum to 1.
 * Positions come from anywhere in the grid. */
static struct box3 box_before(const struct box3 *box, const struct deformation *field)
{
    double from_base[16];
    struct box3 vectors = box3_empty();
    const size_t nodes = field->dim[0] * field->dim[1] * field->dim[2];
    if (!mat4_invert_affine(from_base, field->base)) {
        return (struct box3){{-0.5, -0.5, -0.5},
                             {(double)field->dim[0] - 0.5, (double)field->dim[1] - 0.5, (double)field->dim[2] - 0.5}};
    }
    box3_add(&vectors, (const double[3]){0}); /* outside */
    for (size_t n = 0; n < nodes; n++) {
        double v[3];
        for (size_t a = 0; a < 3; a++) {
            v[a] = field->coefficients ? field->coefficients[a * nodes + n] : (double)field->vectors[3 * n + a];
        }
        box3_add(&vectors, v);
    }
    vectors = box3_image(&vectors, field->linear);
    struct box3 reach;
    vec3_sub(reach.low, box->low, vectors.high);
    vec3_sub(reach.high, box->high, vectors.low);
    return box3_image(&reach, from_base);
}

/* The atlas's voxels: where they are, how many, and their shortest edge, INFINITY without any. */
static struct box3 box_of_atlas(double *edge, double *voxels, const conus_atlas *atlas)
{
    struct box3 box = box3_empty();
    *edge = INFINITY;
    *voxels = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const conus_volume_info *info = &atlas->volumes[i].info;
        const struct box3 own = space_grid_box(info);
        box3_join(&box, own.low, own.high);
        *edge = fmin(*edge, fmin(info->spacing[0], fmin(info->spacing[1], info->spacing[2])));
        *voxels = fmax(*voxels, (double)info->dim[0] * (double)info->dim[1] * (double)info->dim[2]);
    }
    return box;
}

/* Leaves out what is beyond `box`, in indices of the first field. `counts` are voxels `step` apart from `start` on. */
static void crop(double counts[3], double start[3], const double step[3], const struct box3 *box)
{
    for (int a = 0; a < 3; a++) {
        double first = fmin(fmax(floor((box->low[a] - start[a]) / step[a]) - 1, 0), counts[a] - 1);
        double last = fmin(fmax(ceil((box->high[a] - start[a]) / step[a]) + 1, first), counts[a] - 1);
        start[a] += first * step[a];
        counts[a] = last - first + 1;
    }
}

/* How many voxels of the atlas's own, of those that are finest along it, the vector `step` passes; what a field does to
 * it on its way to voxels that were resampled does not count. */
static double voxels_along(const conus_atlas *atlas, const double step[3])
{
    double most = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        const struct volume_source *source = volume->source;
        double passed[3];
        mat4_direction(passed, source ? atlas->own_from_world : volume->voxel_from_world, step);
        if (source) { /* whose matrix has the affine behind its first field */
            for (size_t w = atlas->warp_count - 1; w > source->first_warp; w--) {
                mat4_direction(passed, atlas->warps[w].after, passed);
            }
            mat4_direction(passed, source->voxel_from_world, passed);
        }
        most = fmax(most, vec3_length(passed));
    }
    return most;
}

double warp_coarseness(const double atlas_from_voxel[16], const conus_atlas *atlas)
{
    double most = 0;
    for (int a = 0; a < 3; a++) {
        most = fmax(most, voxels_along(atlas, atlas_from_voxel + 4 * a));
    }
    return most;
}

conus_status warp_grid(conus_volume_info *out, const conus_atlas *atlas, const struct deformation *fields, size_t count)
{
    const struct deformation *field = &fields[count - 1];
    conus_volume_info grid = {.volume_count = 1};
    double matrix[16];
    double edge;
    double voxels;
    double counts[3];
    double start[3];
    double step[3];
    struct box3 box = box_of_atlas(&edge, &voxels, atlas);
    bool has_voxels = isfinite(edge);
    for (int a = 0; a < 3; a++) {
        const double *column = field->world_from_voxel + 4 * a;
        if (field->coefficients) {
            step[a] = (has_voxels ? edge : 1) / vec3_length(column);
            counts[a] = floor((double)(field->dim[a] - 3) / step[a] + 1e-9) + 1;
            start[a] = 1;
        } else {
            double parts = fmax(1, ceil(voxels_along(atlas, column) / WARP_AS_FINE));
            step[a] = 1 / parts;
            /* Nodes stay centres of voxels, of which an even number needs one more: halfway between the atlas's, areas
             * would lie half a voxel off. */
            counts[a] = (double)field->dim[a] * parts + (fmod(parts, 2) == 0 ? 1 : 0);
            start[a] = -floor(parts / 2) / parts;
        }
    }
    if (has_voxels && counts[0] * counts[1] * counts[2] > PLAIN) {
        for (size_t i = 0; i < count; i++) {
            box = box_before(&box, &fields[i]);
            box = i + 1 < count ? box3_image(&box, fields[i].world_from_voxel) : box;
        }
        crop(counts, start, step, &box);
    }
    double wanted = counts[0] * counts[1] * counts[2];
    double most = has_voxels ? fmax(MOST, MOST_TIMES * voxels) : NONE_MADE;
    if (!(wanted <= most)) {
        return fail(CONUS_ERROR_DATA,
                    "the warped atlas would have %.0f x %.0f x %.0f voxels of the size of its smallest, allowed are "
                    "%.0f in all: grid=IMAGE is needed",
                    counts[0], counts[1], counts[2], most);
    }
    mat4_point(matrix + 12, field->world_from_voxel, start);
    matrix[3] = matrix[7] = matrix[11] = 0;
    matrix[15] = 1;
    for (int a = 0; a < 3; a++) {
        vec3_scale(matrix + 4 * a, field->world_from_voxel + 4 * a, step[a]);
        grid.dim[a] = (size_t)counts[a];
    }
    conus_status status = space_describe(&grid, matrix, field->coefficients ? "B-spline" : "field");
    return GIVE(status, out, grid, 0);
}
