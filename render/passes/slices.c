/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the planes over a volume. */
#include "render/passes/shapes.h"

#include "base/geometry/math3.h"

uint32_t slices_default(const size_t dim[3])
{
    size_t longest = dim[0] > dim[1] ? dim[0] : dim[1];
    longest = longest > dim[2] ? longest : dim[2];
    return (uint32_t)floor(sqrt(2) * (double)longest);
}

uint32_t slices_of_id_pass(uint32_t slices, double fraction, const size_t dim[3])
{
    static const double rounding = 1e-12; /* 0.29 of 100 are 29, and 28.999999999999996 in double */
    double all = slices ? slices : slices_default(dim);
    double part = floor(all * (fraction > 0 ? fraction : SLICES_FRACTION) * (1 + rounding));
    return part > 1 ? (uint32_t)part : 1;
}

struct slices slices_over(const size_t dim[3], const double world_from_voxel[16], const double eye[3],
                          const double axis[3], uint32_t count)
{
    double nearest = INFINITY;
    double farthest = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        double point[3];
        for (int a = 0; a < 3; a++) {
            point[a] = corner >> a & 1 ? (double)dim[a] - 0.5 : -0.5;
        }
        mat4_point(point, world_from_voxel, point);
        vec3_sub(point, point, eye);
        double depth = vec3_dot(point, axis);
        nearest = fmin(nearest, depth);
        farthest = fmax(farthest, depth);
    }
    nearest = fmax(nearest, 0);
    if (!(farthest > nearest)) {
        return (struct slices){0};
    }
    return (struct slices){.start = nearest, .spacing = (farthest - nearest) / count, .count = count};
}
