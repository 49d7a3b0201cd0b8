/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a deformation field takes points. */
#include "atlas/deformation/deformation.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Nearer to a node than this, in steps of the grid, only the node counts: what is behind it may be NaN. */
#define ON_NODE 1e-9

/* The eight nodes around a point. */
struct cell {
    const float *corner[8]; /* bit 0: the second along i; bit 1: along j; bit 2: along k */
    double part[3];
    bool flat[3]; /* at the border, where the value does not change */
};

static void find_cell(struct cell *out, const struct deformation *field, const double q[3])
{
    size_t low[3];
    size_t high[3];
    for (int a = 0; a < 3; a++) {
        double most = (double)(field->dim[a] - 1);
        double x = fmin(fmax(q[a], 0), most);
        double cell = fmin(floor(x), most - 1);
        out->flat[a] = q[a] < 0 || q[a] > most;
        out->part[a] = x - cell;
        low[a] = (size_t)cell + (out->part[a] > 1 - ON_NODE);
        high[a] = (size_t)cell + (out->part[a] >= ON_NODE);
    }
    for (int c = 0; c < 8; c++) {
        size_t i = c & 1 ? high[0] : low[0];
        size_t j = c & 2 ? high[1] : low[1];
        size_t k = c & 4 ? high[2] : low[2];
        out->corner[c] = field->vectors + 3 * (i + field->dim[0] * (j + field->dim[1] * k));
    }
}

static double between(double a, double b, double part)
{
    return a + part * (b - a);
}

/* Component n of the vector in the cell. */
static double value_in(const struct cell *cell, int n)
{
    double along[4];
    for (int c = 0; c < 4; c++) {
        along[c] = between((double)cell->corner[2 * c][n], (double)cell->corner[2 * c + 1][n], cell->part[0]);
    }
    return between(between(along[0], along[1], cell->part[1]), between(along[2], along[3], cell->part[1]),
                   cell->part[2]);
}

/* How component n changes along an axis: the mean of the four edges by their nearness. */
static double slope_in(const struct cell *cell, int n, int axis)
{
    static const int bits[3] = {1, 2, 4};
    int u = (axis + 1) % 3;
    int v = (axis + 2) % 3;
    double edges[4];
    for (int e = 0; e < 4; e++) {
        int c = (e & 1 ? bits[u] : 0) + (e & 2 ? bits[v] : 0);
        edges[e] = (double)cell->corner[c + bits[axis]][n] - (double)cell->corner[c][n];
    }
    return between(between(edges[0], edges[1], cell->part[u]), between(edges[2], edges[3], cell->part[u]),
                   cell->part[v]);
}

static void place_vector(double out[3], const struct deformation *field, const double q[3], const double vector[3])
{
    double base[3];
    mat4_point(base, field->base, q);
    mat4_direction(out, field->linear, vector);
    vec3_add_scaled(out, base, 1, out);
}

void deformation_at(double out[3], const struct deformation *field, const double q[3])
{
    struct cell cell;
    find_cell(&cell, field, q);
    const double vector[3] = {value_in(&cell, 0), value_in(&cell, 1), value_in(&cell, 2)};
    place_vector(out, field, q, vector);
}

void deformation_node(double out[3], const struct deformation *field, const size_t node[3])
{
    const float *v = field->vectors + 3 * (node[0] + field->dim[0] * (node[1] + field->dim[1] * node[2]));
    const double q[3] = {(double)node[0], (double)node[1], (double)node[2]};
    const double vector[3] = {(double)v[0], (double)v[1], (double)v[2]};
    place_vector(out, field, q, vector);
}

void deformation_slope(double out[3], double columns[3][3], const struct deformation *field, const double q[3])
{
    struct cell cell;
    find_cell(&cell, field, q);
    const double vector[3] = {value_in(&cell, 0), value_in(&cell, 1), value_in(&cell, 2)};
    for (int axis = 0; axis < 3; axis++) {
        double change[3] = {0};
        for (int n = 0; !cell.flat[axis] && n < 3; n++) {
            change[n] = slope_in(&cell, n, axis);
        }
        mat4_direction(change, field->linear, change);
        vec3_add_scaled(columns[axis], field->base + (ptrdiff_t)4 * axis, 1, change);
    }
    place_vector(out, field, q, vector);
}

bool deformation_holds(const struct deformation *field, const double q[3])
{
    for (int a = 0; a < 3; a++) {
        if (!(q[a] >= -0.5 && q[a] < (double)field->dim[a] - 0.5)) {
            return false;
        }
    }
    return true;
}

bool deformation_point(double out[3], const struct deformation *field, const double p[3])
{
    double q[3];
    mat4_point(q, field->voxel_from_world, p);
    if (deformation_holds(field, q)) {
        deformation_at(out, field, q);
    } else if (field->stays_outside) {
        memmove(out, p, 3 * sizeof *out);
    } else {
        out[0] = out[1] = out[2] = NAN;
    }
    return vec3_is_finite(out);
}

bool warps_point(double out[3], const struct warp *warps, size_t count, const double p[3])
{
    bool goes = true;
    memmove(out, p, 3 * sizeof *out);
    for (size_t i = count; i-- > 0 && goes;) {
        goes = deformation_point(out, &warps[i].field, out);
        mat4_point(out, warps[i].after, out);
    }
    return goes;
}

void deformation_finish(struct deformation *field)
{
    if (!field->is_borrowed) {
        memory_free(field->vectors);
    }
    *field = (struct deformation){0};
}
