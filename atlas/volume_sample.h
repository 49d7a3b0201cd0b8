/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Trilinear interpolation between voxel centres. */
#ifndef CONUS_ATLAS_VOLUME_SAMPLE_H
#define CONUS_ATLAS_VOLUME_SAMPLE_H

#include "atlas/volume.h"

/** A coordinate between two voxels: array offsets of both, and the weight of the second. */
struct volume_neighbours {
    size_t low, high;
    double part;
};

static inline struct volume_neighbours volume_find_neighbours(double x, size_t dim, size_t step)
{
    double most = (double)dim - 1;
    x = x > 0 ? x : 0;
    x = x < most ? x : most;
    ptrdiff_t index = (ptrdiff_t)x; /* to signed numbers and from them is quicker */
    size_t low = (size_t)index;
    return (struct volume_neighbours){low * step, (low + 1 < dim ? low + 1 : low) * step, x - (double)index};
}

/** Of eight voxels the values of the lower ones along the first axis, and how much more the upper ones have: a and b, c
 * and d are the lower and the upper one along the second axis, a and b lower along the third. */
struct volume_cell {
    double a, b, c, d;
    double a_rise, b_rise, c_rise, d_rise;
};

static inline double volume_rise(double *low, const struct volume *volume, size_t row,
                                 const struct volume_neighbours *x)
{
    *low = (double)volume_value(volume, row + x->low);
    return (double)volume_value(volume, row + x->high) - *low;
}

static inline void volume_read_cell(struct volume_cell *out, const struct volume *volume,
                                    const struct volume_neighbours *x, const struct volume_neighbours *y,
                                    const struct volume_neighbours *z)
{
    out->a_rise = volume_rise(&out->a, volume, y->low + z->low, x);
    out->b_rise = volume_rise(&out->b, volume, y->high + z->low, x);
    out->c_rise = volume_rise(&out->c, volume, y->low + z->high, x);
    out->d_rise = volume_rise(&out->d, volume, y->high + z->high, x);
}

/** At parts of the way along the three axes. */
static inline double volume_in_cell(const struct volume_cell *cell, double x, double y, double z)
{
    double low = cell->a + x * cell->a_rise;
    double high = cell->c + x * cell->c_rise;
    low += y * (cell->b + x * cell->b_rise - low);
    high += y * (cell->d + x * cell->d_rise - high);
    return low + z * (high - low);
}

/** Whether a voxel's cell holds @p p, in index space. */
static inline bool volume_reaches(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    return p[0] >= -0.5 && p[0] < (double)dim[0] - 0.5 && p[1] >= -0.5 && p[1] < (double)dim[1] - 0.5 && p[2] >= -0.5 &&
           p[2] < (double)dim[2] - 0.5;
}

/** The value at @p p, in index space; outside of the voxel centres that of the border. */
static inline double volume_trilinear(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    struct volume_neighbours x = volume_find_neighbours(p[0], dim[0], 1);
    struct volume_neighbours y = volume_find_neighbours(p[1], dim[1], dim[0]);
    struct volume_neighbours z = volume_find_neighbours(p[2], dim[2], dim[0] * dim[1]);
    struct volume_cell cell;
    volume_read_cell(&cell, volume, &x, &y, &z);
    return volume_in_cell(&cell, x.part, y.part, z.part);
}

#endif
