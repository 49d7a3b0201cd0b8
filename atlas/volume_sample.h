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
    size_t low = (size_t)x;
    return (struct volume_neighbours){low * step, (low + 1 < dim ? low + 1 : low) * step, x - (double)low};
}

static inline double volume_along(const struct volume *volume, size_t row, const struct volume_neighbours *x)
{
    double low = (double)volume_value(volume, row + x->low);
    return low + x->part * ((double)volume_value(volume, row + x->high) - low);
}

/** The value at @p p, in index space; outside of the voxel centres that of the border. */
static inline double volume_trilinear(const struct volume *volume, const double p[3])
{
    const size_t *dim = volume->info.dim;
    struct volume_neighbours x = volume_find_neighbours(p[0], dim[0], 1);
    struct volume_neighbours y = volume_find_neighbours(p[1], dim[1], dim[0]);
    struct volume_neighbours z = volume_find_neighbours(p[2], dim[2], dim[0] * dim[1]);
    double a = volume_along(volume, z.low + y.low, &x);
    double b = volume_along(volume, z.high + y.low, &x);
    a += y.part * (volume_along(volume, z.low + y.high, &x) - a);
    b += y.part * (volume_along(volume, z.high + y.high, &x) - b);
    return a + z.part * (b - a);
}

#endif
