/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Vectors and matrices of double, for three dimensions. Matrices are column-major double[16] with the last row
 * 0 0 0 1 (affine); `a_from_b` maps b coordinates to a. */
#ifndef CONUS_BASE_MATH3_H
#define CONUS_BASE_MATH3_H

#include "base/geometry/arc.h"
#include "base/tolerance.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define MATH3_PI 3.14159265358979323846

static inline double radians_from_degrees(double degrees)
{
    return degrees * (MATH3_PI / 180);
}

static inline double degrees_from_radians(double radians)
{
    return radians * (180 / MATH3_PI);
}

static inline double vec3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec3_length(const double a[3])
{
    return sqrt(vec3_dot(a, a));
}

static inline void vec3_cross(double out[3], const double a[3], const double b[3])
{
    double x = a[1] * b[2] - a[2] * b[1];
    double y = a[2] * b[0] - a[0] * b[2];
    double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

/** out = a + s b; the three may be the same array. */
static inline void vec3_add_scaled(double out[3], const double a[3], double s, const double b[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = a[i] + s * b[i];
    }
}

static inline void vec3_sub(double out[3], const double a[3], const double b[3])
{
    vec3_add_scaled(out, a, -1, b);
}

static inline void vec3_scale(double out[3], const double a[3], double s)
{
    for (int i = 0; i < 3; i++) {
        out[i] = a[i] * s;
    }
}

/** out = a / |a|; false (out untouched) where the length is 0 or not finite. */
static inline bool vec3_normalise(double out[3], const double a[3])
{
    double length = vec3_length(a);
    if (!(length > 0) || !isfinite(length)) {
        return false;
    }
    vec3_scale(out, a, 1 / length);
    return true;
}

/** Between two directions, radians, 0 to pi. */
static inline double vec3_angle(const double a[3], const double b[3])
{
    double cross[3];
    vec3_cross(cross, a, b);
    return arc_tangent(vec3_length(cross), vec3_dot(a, b));
}

/** Turns a vector about a unit axis by the right-hand rule (Rodrigues); @p out may be @p v. */
static inline void vec3_turn(double out[3], const double v[3], const double axis[3], double angle)
{
    double across[3];
    double sum[3];
    double along = vec3_dot(axis, v) * (1 - cos(angle));
    vec3_cross(across, axis, v);
    vec3_scale(sum, v, cos(angle));
    vec3_add_scaled(sum, sum, sin(angle), across);
    vec3_add_scaled(out, sum, along, axis);
}

static inline bool vec3_is_finite(const double a[3])
{
    return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

static inline void mat4_identity(double m[16])
{
    for (int i = 0; i < 16; i++) {
        m[i] = i % 5 == 0;
    }
}

/** out = a b. */
static inline void mat4_multiply(double out[16], const double a[16], const double b[16])
{
    double m[16];
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) {
                sum += a[4 * k + row] * b[4 * column + k];
            }
            m[4 * column + row] = sum;
        }
    }
    memcpy(out, m, sizeof m);
}

/** out = the linear part of m times v (a direction: no translation). */
static inline void mat4_direction(double out[3], const double m[16], const double v[3])
{
    double r[3];
    for (int row = 0; row < 3; row++) {
        r[row] = m[row] * v[0] + m[4 + row] * v[1] + m[8 + row] * v[2];
    }
    memcpy(out, r, sizeof r);
}

/** out = m times the point p. */
static inline void mat4_point(double out[3], const double m[16], const double p[3])
{
    mat4_direction(out, m, p);
    for (int row = 0; row < 3; row++) {
        out[row] += m[12 + row];
    }
}

/** Sets the last row to 0 0 0 1 if it is that but for an inverse in float, twice the TOLERANCE; false (m untouched)
 * otherwise. Programs write 0.99999994. */
static inline bool mat4_settle_last_row(double m[16])
{
    static const double last[4] = {0, 0, 0, 1};
    bool near = true;
    for (int column = 0; column < 4; column++) {
        near = near && fabs(m[4 * column + 3] - last[column]) <= 2 * TOLERANCE;
    }
    for (int column = 0; near && column < 4; column++) {
        m[4 * column + 3] = last[column];
    }
    return near;
}

/** Determinant of the linear part. */
static inline double mat4_determinant3(const double m[16])
{
    double cross[3];
    vec3_cross(cross, m + 4, m + 8);
    return vec3_dot(m, cross);
}

static inline bool mat4_is_same(const double a[16], const double b[16])
{
    bool same = true;
    for (int i = 0; i < 16; i++) {
        same = same && a[i] == b[i];
    }
    return same;
}

/** Whether the last row is 0 0 0 1. */
static inline bool mat4_is_affine(const double m[16])
{
    return m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1;
}

/** out = inverse of m; false (out untouched) where m is not affine, its linear part is singular (|det| below 1e-12 of
 * the product of the column lengths), or anything is not finite, of the inverse, too. */
static inline bool mat4_invert_affine(double out[16], const double m[16])
{
    double det = mat4_determinant3(m);
    double scale = vec3_length(m) * vec3_length(m + 4) * vec3_length(m + 8);
    bool is_finite = isfinite(det) && isfinite(scale) && vec3_is_finite(m + 12);
    if (!mat4_is_affine(m) || !is_finite || !(fabs(det) > 1e-12 * scale)) {
        return false;
    }
    double r[16] = {0};
    for (int i = 0; i < 3; i++) { /* row i of the inverse = cross product of the other two columns / det */
        double row[3];
        vec3_cross(row, m + 4 * ((i + 1) % 3), m + 4 * ((i + 2) % 3));
        for (int k = 0; k < 3; k++) {
            r[4 * k + i] = row[k] / det;
        }
        r[12 + i] = -vec3_dot(row, m + 12) / det;
    }
    r[15] = 1;
    if (!vec3_is_finite(r) || !vec3_is_finite(r + 4) || !vec3_is_finite(r + 8) || !vec3_is_finite(r + 12)) {
        return false;
    }
    memcpy(out, r, sizeof r);
    return true;
}

#endif
