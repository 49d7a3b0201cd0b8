/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Geometry in three dimensions: functions of arcs with the same bits everywhere, vectors and matrices,
 * needles, and convex bodies. */
#ifndef CONUS_BASE_GEOMETRY_MATH3_H
#define CONUS_BASE_GEOMETRY_MATH3_H

#include "base/tolerance.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Sine, cosine and arc tangent whose bits do not depend on the C library, as tangent() in tangent.c: sums of many
 * arcs around a surface show the last bit of theirs in the ninth digit of a volume. */

/** sin(@p x) and cos(@p x), within 2e-16, for |x| <= 1000 radians. NaN of what is not finite. */
void sine_cosine(double *sine, double *cosine, double x);

static inline double sine_of(double x)
{
    double sine;
    double cosine;
    sine_cosine(&sine, &cosine, x);
    return sine;
}

static inline double cosine_of(double x)
{
    double sine;
    double cosine;
    sine_cosine(&sine, &cosine, x);
    return cosine;
}

/** The angle from the x axis to (@p x, @p y), -pi to pi, within 2 units in the last place. @p y where both are 0. NaN
 * where one is not finite. */
double arc_tangent(double y, double x);

/* A tangent whose bits do not depend on the C library. */

/** tan(@p x), rounded to nearest, for 0 <= x < pi / 2. C libraries differ in the last bit of theirs, and with it the
 * slope of a cone: the same question would have other rows in a browser. */
double tangent(double x);

/* Vectors and matrices of double, for three dimensions. Matrices are column-major double[16] with the last row 0 0 0
 * 1 (affine); `a_from_b` maps b coordinates to a. */

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

/* Boxes along the axes, and the boxes around points. */

/** Its corners of least and of greatest coordinates; empty where low[0] is above high[0]. */
struct box3 {
    double low[3], high[3];
};

static inline struct box3 box3_empty(void)
{
    return (struct box3){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/** Makes the box hold @p p, too; a coordinate that is NaN does not count. */
static inline void box3_add(struct box3 *box, const double p[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], p[a]);
        box->high[a] = fmax(box->high[a], p[a]);
    }
}

/** Makes the box hold another one, of these corners; of an empty one nothing. */
static inline void box3_join(struct box3 *box, const double low[3], const double high[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], low[a]);
        box->high[a] = fmax(box->high[a], high[a]);
    }
}

/** Corner number 0 to 7: bit a of it stands for the greater coordinate along axis a. */
static inline void box3_corner(double out[3], const struct box3 *box, int corner)
{
    for (int a = 0; a < 3; a++) {
        out[a] = corner >> a & 1 ? box->high[a] : box->low[a];
    }
}

/** The box around the image of @p box under the affine @p m. */
static inline struct box3 box3_image(const struct box3 *box, const double m[16])
{
    struct box3 image = box3_empty();
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        box3_corner(p, box, corner);
        mat4_point(p, m, p);
        box3_add(&image, p);
    }
    return image;
}

/* A needle, a part of a line, and how far it is from boxes and segments (Eq. 21). */

/** Its points are origin + t direction, near <= t <= far; both are finite. */
struct needle {
    double origin[3];    /**< mm           */
    double direction[3]; /**< A unit vector. */
    double near, far;    /**< mm             */
};

/** The point of the needle's line at @p depth. */
void needle_point(double out[3], const struct needle *needle, double depth);

/** A needle as boxes along the axes of another frame see it. The axes count as perpendicular. */
struct needle_frame {
    double at[3];     /**< The origin, in the frame's units.                                               */
    double step[3];   /**< Steps per mm along the needle. 0 below 1e-12 of a mm: the needle is along the others. */
    double per[3];    /**< 1 / step; 0 where that is 0.                                                    */
    double square[3]; /**< (step scale)^2.                                                                 */
    double scale[3];  /**< mm per unit.                                                                    */
    double near, far;
};

/** @p frame_from_world NULL: the world. */
void needle_frame_init(struct needle_frame *out, const struct needle *needle, const double frame_from_world[16]);

/** Distance in mm from the box between the corners @p low and @p high. @p depth receives the least depth at which the
 * needle is so near: 0 and where it comes in, if it does. */
double needle_box(double *depth, const struct needle_frame *frame, const double low[3], const double high[3]);

/** Distance from the segment from @p a to @p b, which may be one point. @p depth receives the least depth at which the
 * needle is so near, @p point the segment's point there. */
double needle_segment(double *depth, double point[3], const struct needle *needle, const double a[3],
                      const double b[3]);

/* Boxes, tetrahedra and other convex polyhedra that planes across an axis cut in two (Eq. 16). */

/** An edge of a face. The edges of a face lie one after the other, in any order, and run round it in one sense; the
 * face beside it has the same edge the other way round. */
struct convex_edge {
    double from[3], to[3];
    uint32_t face;
    bool is_new; /**< Only while a polyhedron is cut. */
};

/** Holds the edges of polyhedra. Those made last are dropped by setting `count` back. */
struct convex_stack {
    struct convex_edge *edges; /**< Owned. */
    size_t count, capacity;
};

struct convex {
    double low[3], high[3]; /**< Bounds. */
    double volume;
    size_t first, count; /**< Edges on the stack; none = it fills its bounds. */
    uint32_t faces;      /**< Larger than the number of any of its faces. */
};

void convex_finish(struct convex_stack *stack);

/** A box with faces across the axes. */
struct convex convex_box(const double low[3], const double high[3]);

/** The tetrahedron of these corners, in either order. False without memory. */
bool convex_tetrahedron(struct convex *out, struct convex_stack *stack, const double corners[4][3]);

/** The image of @p convex under the affine @p m. A box stays one if m maps axes to axes, within 10⁻⁶ over the box.
 * False without memory. */
bool convex_move(struct convex *out, struct convex_stack *stack, const struct convex *convex, const double m[16]);

/** The part of @p convex below @p at along @p axis or, with @p above, above it; `at` is between its bounds. False
 * without memory. */
bool convex_cut(struct convex *out, struct convex_stack *stack, const struct convex *convex, int axis, double at,
                bool above);

#endif
