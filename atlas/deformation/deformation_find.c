/* SPDX-License-Identifier: BSD-3-Clause */
/* Which point a field takes to a given one. */
#include "atlas/deformation/deformation_find.h"

#include "base/geometry/math3.h"

enum { STEPS = 100, HALVINGS = 20, LATTICE = 10 }; /* LATTICE: nodes along an axis that are tried as a start */

static const double inside = 0.5 - 1e-9; /* half a step beyond the last node, less rounding */

static void hold_inside(double q[3], const struct deformation *field)
{
    for (int a = 0; a < 3; a++) {
        q[a] = fmin(fmax(q[a], -inside), (double)(field->dim[a] - 1) + inside);
    }
}

/* Newton's step, from the residual in mm to indices; false where the map turns flat. */
static bool newton_step(double out[3], double columns[3][3], const double residual[3])
{
    double m[16] = {[15] = 1};
    double inverse[16];
    for (int a = 0; a < 3; a++) {
        memcpy(m + (ptrdiff_t)4 * a, columns[a], sizeof columns[a]);
    }
    if (!mat4_invert_affine(inverse, m)) {
        return false;
    }
    mat4_direction(out, inverse, residual);
    return true;
}

/* Goes along `step`, or a part of it, to where the residual is less. */
static bool go_along(double q[3], double residual[3], const struct deformation *field, const double target[3],
                     const double step[3])
{
    double length = vec3_length(residual);
    for (int i = 0; i < HALVINGS; i++) {
        double part = ldexp(1, -i);
        double next[3];
        double left[3];
        vec3_add_scaled(next, q, part, step);
        hold_inside(next, field);
        deformation_at(left, field, next);
        vec3_sub(left, target, left);
        if (vec3_length(left) <= length * (1 - part / 1000)) { /* false for NaN */
            memcpy(q, next, sizeof next);
            memcpy(residual, left, sizeof left);
            return true;
        }
    }
    return false;
}

/* From the indices q to those of the point; false where it comes to an end before. */
static bool search(double q[3], const struct deformation *field, const double target[3])
{
    double residual[3];
    hold_inside(q, field);
    deformation_at(residual, field, q);
    vec3_sub(residual, target, residual);
    for (int i = 0; i < STEPS && vec3_length(residual) > DEFORMATION_TOLERANCE; i++) {
        double at[3];
        double step[3];
        double columns[3][3];
        deformation_slope(at, columns, field, q);
        bool goes = newton_step(step, columns, residual) && go_along(q, residual, field, target, step);
        if (!goes) { /* the field as a whole knows a way */
            mat4_direction(step, field->start, residual);
            goes = go_along(q, residual, field, target, step);
        }
        if (!goes) {
            break;
        }
    }
    return vec3_length(residual) <= DEFORMATION_TOLERANCE;
}

/* Of some nodes the one that goes nearest to the target; false where none goes anywhere. */
static bool nearest_node(double out[3], const struct deformation *field, const double target[3])
{
    double best = INFINITY;
    double step[3];
    for (int a = 0; a < 3; a++) {
        step[a] = (double)(field->dim[a] - 1) / (LATTICE - 1);
    }
    for (int n = 0; n < LATTICE * LATTICE * LATTICE; n++) {
        const int at[3] = {n % LATTICE, n / LATTICE % LATTICE, n / LATTICE / LATTICE};
        const double q[3] = {floor(at[0] * step[0]), floor(at[1] * step[1]), floor(at[2] * step[2])};
        double x[3];
        deformation_at(x, field, q);
        vec3_sub(x, target, x);
        if (vec3_length(x) < best) {
            best = vec3_length(x);
            memcpy(out, q, sizeof q);
        }
    }
    return best < INFINITY;
}

static bool is_at_border(const double q[3], const struct deformation *field)
{
    for (int a = 0; a < 3; a++) {
        if (!(q[a] > -inside && q[a] < (double)(field->dim[a] - 1) + inside)) {
            return true;
        }
    }
    return false;
}

/* Where nodes go, and as far beyond as the border's half steps may reach. */
static bool is_within_reach(const struct deformation *field, const double target[3])
{
    for (int a = 0; a < 3; a++) {
        double more = (field->high[a] - field->low[a]) / 2;
        if (!(target[a] >= field->low[a] - more && target[a] <= field->high[a] + more)) {
            return false;
        }
    }
    return true;
}

static enum deformation_found outside(double out[3], const struct deformation *field, const double target[3])
{
    double q[3];
    mat4_point(q, field->voxel_from_world, target);
    bool stays = field->stays_outside && !deformation_holds(field, q);
    for (int a = 0; a < 3; a++) {
        out[a] = stays ? target[a] : NAN;
    }
    return DEFORMATION_OUTSIDE;
}

enum deformation_found deformation_find(double out[3], const struct deformation *field, const double target[3])
{
    double q[3];
    double goal[3];
    memcpy(goal, target, sizeof goal);
    if (!is_within_reach(field, goal)) {
        return outside(out, field, goal);
    }
    mat4_point(q, field->start, goal);
    if (search(q, field, goal) || (nearest_node(q, field, goal) && search(q, field, goal))) {
        mat4_point(out, field->world_from_voxel, q);
        return DEFORMATION_FOUND;
    }
    return is_at_border(q, field) ? outside(out, field, goal) : DEFORMATION_LOST;
}
