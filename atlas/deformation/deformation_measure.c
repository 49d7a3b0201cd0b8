/* SPDX-License-Identifier: BSD-3-Clause */
/* The affine that is next to a field, and its reach, by some of its nodes. */
#include "atlas/deformation/deformation.h"
#include "base/geometry/math3.h"

enum { LATTICE = 64 }; /* nodes along an axis that are enough */

/* Sums over nodes. */
struct sums {
    double count;
    double q[3], qq[3]; /* of indices and their squares */
    double x[3];        /* of where nodes go */
    double xq[3][3];    /* [axis of q][axis of x] */
};

static void add_node(struct sums *sums, struct deformation *field, const size_t node[3])
{
    const double q[3] = {(double)node[0], (double)node[1], (double)node[2]};
    double x[3];
    deformation_node(x, field, node);
    if (!vec3_is_finite(x)) {
        return;
    }
    sums->count++;
    for (int a = 0; a < 3; a++) {
        field->low[a] = fmin(field->low[a], x[a]);
        field->high[a] = fmax(field->high[a], x[a]);
        sums->q[a] += q[a];
        sums->qq[a] += q[a] * q[a];
        sums->x[a] += x[a];
        vec3_add_scaled(sums->xq[a], sums->xq[a], q[a], x);
    }
}

/* By each axis of indices alone: on a whole grid they do not go together, and a start needs no more. */
static void fit(double out[16], const struct sums *sums)
{
    mat4_identity(out);
    for (int b = 0; b < 3; b++) {
        out[12 + b] = sums->x[b] / sums->count;
    }
    for (int a = 0; a < 3; a++) {
        double mean = sums->q[a] / sums->count;
        double spread = sums->qq[a] - sums->count * mean * mean;
        for (int b = 0; b < 3; b++) {
            out[4 * a + b] = (sums->xq[a][b] - mean * sums->x[b]) / spread;
            out[12 + b] -= out[4 * a + b] * mean;
        }
    }
}

conus_status deformation_measure(struct deformation *field)
{
    struct sums sums = {0};
    double near[16];
    size_t node[3];
    size_t step[3];
    for (int a = 0; a < 3; a++) {
        step[a] = field->dim[a] / LATTICE + 1;
        field->low[a] = INFINITY;
        field->high[a] = -INFINITY;
    }
    for (node[2] = 0; node[2] < field->dim[2]; node[2] += step[2]) {
        for (node[1] = 0; node[1] < field->dim[1]; node[1] += step[1]) {
            for (node[0] = 0; node[0] < field->dim[0]; node[0] += step[0]) {
                add_node(&sums, field, node);
            }
        }
    }
    fit(near, &sums);
    return mat4_invert_affine(field->start, near)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "the field takes all points to a plane, or nowhere");
}
