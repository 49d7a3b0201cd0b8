/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows of voxels as a region sees them, and the choice of a kernel that cuts them. */
#include "selection/region/region.h"

#include "base/geometry/math3.h"
#include "base/simd/processor.h"

/* Added to a discriminant, as a part of its terms, and to a range, in rows: far more than rounding. */
static const double WIDER = 1e-9;
static const double MORE_ROWS = 0.01;

/* Distance from a border, as a part of the numbers' size, from which on a cut and region_has() agree. */
static const double DOUBT = 4e-7;

/* The size of every coordinate on the way. */
static double size_of_numbers(const struct region *region, const struct volume *volume)
{
    double size = vec3_length(region->origin);
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = corner >> a & 1 ? (double)(volume->info.dim[a] - 1) : 0;
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        size = fmax(size, vec3_length(p));
    }
    return 2 * size;
}

/* Puts the vector v, as the region sees it, into number `at` of the line. Leaves out what does not change along a line.
 */
static void see(struct region_line *out, int at, const struct region *region, const double v[3])
{
    if (region->shape == REGION_BALL) {
        out->depth[at] = out->width[at] = 0;
        memcpy(out->across[at], v, 3 * sizeof *v);
        return;
    }
    out->depth[at] = vec3_dot(v, region->axis);
    out->width[at] = region->sine * out->depth[at];
    out->across[at][0] = region->cosine * vec3_dot(v, region->right);
    out->across[at][1] = region->cosine * vec3_dot(v, region->up);
    out->across[at][2] = 0;
}

region_rows_cutter *region_rows_kernel(size_t index)
{
    size_t fastest = 0;
#if defined(__x86_64__)
    region_rows_cutter *const kernels[] = {region_rows_cut_avx512, region_rows_cut_avx2, region_rows_cut_plain};
    fastest = processor_has_avx512() ? 0 : processor_has_avx2() ? 1 : 2;
#else
    region_rows_cutter *const kernels[] = {region_rows_cut_plain};
#endif
    return index < sizeof kernels / sizeof kernels[0] - fastest ? kernels[fastest + index] : NULL;
}

void region_rows_init(struct region_rows *out, const struct region *region, const struct volume *volume,
                      const int axes[3])
{
    const double *m = volume->info.world_from_voxel;
    *out = (struct region_rows){.region = region, .world_from_voxel = m, .cut = region_rows_kernel(0)};
    out->across_slices = axes[2];
    out->margin = DOUBT * size_of_numbers(region, volume);
    see(&out->row, 1, region, m + 4 * (ptrdiff_t)axes[0]);
    see(&out->column, 1, region, m + 4 * (ptrdiff_t)axes[1]);
    out->curve = out->row.width[1] * out->row.width[1] - vec3_dot(out->row.across[1], out->row.across[1]);
    out->per_depth = 1 / out->row.depth[1];
    out->per_width = 1 / out->row.width[1];
    out->per_curve = 1 / out->curve;
}

void region_rows_place(struct region_rows *rows, size_t k)
{
    double v[3] = {0, 0, 0};
    v[rows->across_slices] = (double)k;
    mat4_point(v, rows->world_from_voxel, v);
    vec3_sub(v, v, rows->region->origin);
    see(&rows->row, 0, rows->region, v);
    rows->row.width[0] += rows->region->radius;
}

/* Row s meets the region's double cone where d[0] + d[1] s + d[2] s^2 is 0 or more: the discriminant of what
 * region_rows_lanes.h solves for each row. */
static void discriminant_of_rows(double d[3], const struct region_rows *rows)
{
    const struct region_line *row = &rows->row;
    const double w[2] = {row->width[0] + 2 * rows->margin, rows->column.width[1]};
    double b[2] = {w[0] * row->width[1], w[1] * row->width[1]};
    double c[3] = {w[0] * w[0], 2 * w[0] * w[1], w[1] * w[1]};
    for (int i = 0; i < 3; i++) {
        const double x[2] = {row->across[0][i], rows->column.across[1][i]};
        b[0] -= x[0] * row->across[1][i];
        b[1] -= x[1] * row->across[1][i];
        c[0] -= x[0] * x[0];
        c[1] -= 2 * x[0] * x[1];
        c[2] -= x[1] * x[1];
    }
    d[0] = b[0] * b[0] - rows->curve * c[0];
    d[1] = 2 * b[0] * b[1] - rows->curve * c[1];
    d[2] = b[1] * b[1] - rows->curve * c[2];
}

bool region_rows_narrow(size_t range[2], const struct region_rows *rows)
{
    double d[3];
    discriminant_of_rows(d, rows);
    if (rows->region->square || !(rows->curve < 0) || !(d[2] < 0)) {
        return true; /* the rows that meet it are not between two */
    }
    double both = d[1] * d[1] - 4 * d[2] * d[0] + WIDER * (d[1] * d[1] + fabs(4 * d[2] * d[0]));
    double root = sqrt(fmax(both, 0));
    double first = ceil((root - d[1]) / (2 * d[2]) - MORE_ROWS);
    double last = floor((-root - d[1]) / (2 * d[2]) + MORE_ROWS);
    if (both < 0 || first > (double)range[1] || last < (double)range[0]) {
        return false;
    }
    range[0] = first > (double)range[0] ? (size_t)first : range[0];
    range[1] = last < (double)range[1] ? (size_t)last : range[1];
    return range[0] <= range[1];
}
