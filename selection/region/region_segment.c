/* SPDX-License-Identifier: BSD-3-Clause */
/* Segments and boxes against a cone, a cylinder or a ball. */
#include "selection/region/region.h"

#include "base/geometry/math3.h"

/* Distance from a border, as a part of the coordinates' size, from which on nothing that is rounded decides. */
static const double DOUBT = 1e-12;

/* Cuts s to at + s step >= 0. */
static bool clip_half(double s[2], double at, double step)
{
    if (step > 0) {
        s[0] = fmax(s[0], -at / step);
    } else if (step < 0) {
        s[1] = fmin(s[1], -at / step);
    } else if (at < 0) {
        return false;
    }
    return s[0] <= s[1];
}

/* Cuts s to |at + s step| <= radius. The nearest point of the line comes first: its distance has the error of a
 * coordinate, where the quadratic's discriminant would have that of a square. */
static bool clip_about(double s[2], const double at[3], const double step[3], double radius)
{
    double square = vec3_dot(step, step);
    double foot = square > 0 ? -vec3_dot(at, step) / square : 0;
    double nearest[3];
    vec3_add_scaled(nearest, at, foot, step);
    double distance = vec3_length(nearest);
    if (distance > radius) {
        return false;
    }
    if (square > 0) {
        double half = sqrt((radius - distance) * (radius + distance) / square);
        s[0] = fmax(s[0], foot - half);
        s[1] = fmin(s[1], foot + half);
    }
    return s[0] <= s[1];
}

/* z^2 - x^2 - y^2 */
static double fall(const double v[3])
{
    double across = sqrt(v[0] * v[0] + v[1] * v[1]);
    return (v[2] - across) * (v[2] + across);
}

/* Cuts s, on which z is 0 or more, to z >= sqrt(x^2 + y^2) for (x, y, z) = at + s step. What a line has in both nappes
 * together is between its roots or beside them; of these parts the first nappe has one. The discriminant is that of
 * a + 2 b s + c s^2, written with the cross product of at and step, so that it is rounded as a coordinate is. */
static bool clip_cone(double s[2], const double at[3], const double step[3])
{
    double a = fall(step);
    double b = at[2] * step[2] - at[0] * step[0] - at[1] * step[1];
    double c = fall(at);
    double cross[3];
    vec3_cross(cross, at, step);
    double leaning = sqrt(cross[0] * cross[0] + cross[1] * cross[1]);
    double d = (leaning - fabs(cross[2])) * (leaning + fabs(cross[2]));
    if (a == 0) {
        return clip_half(s, c, 2 * b);
    }
    if (d < 0 && a < 0) {
        return false;
    }
    double root = sqrt(fmax(d, 0));
    double q = b < 0 ? root - b : -root - b;
    double one = q / a;
    double other = q != 0 ? c / q : 0;
    if (a < 0 || step[2] > 0) {
        s[0] = fmax(s[0], a < 0 ? fmin(one, other) : fmax(one, other));
    }
    if (a < 0 || step[2] < 0) {
        s[1] = fmin(s[1], a < 0 ? fmax(one, other) : fmin(one, other));
    }
    return s[0] <= s[1];
}

/* x, y and z of a vector in the device's frame; scaled, so that |x|, |y| or their length is at most z + radius inside.
 */
static void see(double out[3], const struct region *region, const double v[3])
{
    out[0] = region->cosine * vec3_dot(v, region->right);
    out[1] = region->cosine * vec3_dot(v, region->up);
    out[2] = region->sine * vec3_dot(v, region->axis);
}

bool region_line(double s[2], const struct region *region, const double v[3], const double u[3])
{
    double at[3];
    double step[3];
    if (region->shape == REGION_BALL) {
        return clip_about(s, v, u, region->radius);
    }
    double depth = vec3_dot(v, region->axis);
    double deeper = vec3_dot(u, region->axis);
    if (!clip_half(s, depth - region->near, deeper) ||
        (region->far < INFINITY && !clip_half(s, region->far - depth, -deeper))) {
        return false;
    }
    see(at, region, v);
    see(step, region, u);
    if (region->square) {
        for (int side = 0; side < 4; side++) {
            double sign = side & 1 ? 1 : -1;
            if (!clip_half(s, at[2] + region->radius + sign * at[side >> 1], step[2] + sign * step[side >> 1])) {
                return false;
            }
        }
        return true;
    }
    return region->shape == REGION_CONE ? clip_cone(s, at, step) : clip_about(s, at, step, region->radius);
}

bool region_segment(double out[2], const struct region *region, double ends[2][3], const bool inside[2])
{
    double s[2] = {0, 1};
    if (!(inside[0] && inside[1])) {
        double v[3];
        double u[3];
        vec3_sub(v, ends[0], region->origin);
        vec3_sub(u, ends[1], ends[0]);
        bool found = region_line(s, region, v, u);
        if (inside[0] || inside[1]) {
            s[0] = inside[0] ? 0 : found ? s[0] : 1;
            s[1] = inside[1] ? 1 : found ? s[1] : 0;
        } else {
            double middle[3];
            vec3_add_scaled(middle, ends[0], (s[0] + s[1]) / 2, u);
            if (!found || !region_has(region, middle)) {
                return false;
            }
        }
    }
    out[0] = s[0];
    out[1] = s[1];
    return true;
}

/* A box as offsets from the region's origin. */
struct box {
    double centre[3], half[3];
    double margin; /* mm: what rounding may do */
};

/* Least and greatest n . p of its points. */
static void reach(double out[2], const struct box *box, const double n[3])
{
    double middle = vec3_dot(n, box->centre);
    double spread = fabs(n[0]) * box->half[0] + fabs(n[1]) * box->half[1] + fabs(n[2]) * box->half[2];
    out[0] = middle - spread;
    out[1] = middle + spread;
}

/* By the distance of the box's nearest and farthest points from a border. */
static enum tract_answer answer(double nearest, double farthest, double margin)
{
    return nearest > margin ? TRACT_OUTSIDE : farthest <= -margin ? TRACT_INSIDE : TRACT_PERHAPS;
}

static enum tract_answer test_ball(const struct region *region, const struct box *box)
{
    double gap[3];
    double far[3];
    for (int a = 0; a < 3; a++) {
        gap[a] = fmax(fabs(box->centre[a]) - box->half[a], 0);
        far[a] = fabs(box->centre[a]) + box->half[a];
    }
    return answer(vec3_length(gap) - region->radius, vec3_length(far) - region->radius, box->margin);
}

/* How far the box is beyond the side of a cone or cylinder that faces where (x, y) points, a unit vector. */
static void reach_side(double out[2], const struct region *region, const struct box *box, double x, double y)
{
    double n[3];
    vec3_scale(n, region->axis, -region->sine);
    vec3_add_scaled(n, n, region->cosine * x, region->right);
    vec3_add_scaled(n, n, region->cosine * y, region->up);
    reach(out, box, n);
    out[0] -= region->radius;
    out[1] -= region->radius;
}

static enum tract_answer test_square(const struct region *region, const struct box *box)
{
    double nearest = -INFINITY;
    double farthest = -INFINITY;
    for (int side = 0; side < 4; side++) {
        double sign = side & 1 ? 1 : -1;
        double ends[2];
        reach_side(ends, region, box, side & 2 ? 0 : sign, side & 2 ? sign : 0);
        nearest = fmax(nearest, ends[0]);
        farthest = fmax(farthest, ends[1]);
    }
    return answer(nearest, farthest, box->margin);
}

/* Outside by the plane that touches the cone or cylinder where it faces the box's centre; inside by the corners. */
static enum tract_answer test_round(const struct region *region, const struct box *box)
{
    double x = vec3_dot(box->centre, region->right);
    double y = vec3_dot(box->centre, region->up);
    double away = sqrt(x * x + y * y);
    double ends[2];
    double farthest = -INFINITY;
    reach_side(ends, region, box, away > 0 ? x / away : 1, away > 0 ? y / away : 0);
    for (int corner = 0; corner < 8 && ends[0] <= box->margin && farthest <= -box->margin; corner++) {
        double p[3];
        double seen[3];
        for (int a = 0; a < 3; a++) {
            p[a] = box->centre[a] + (corner >> a & 1 ? box->half[a] : -box->half[a]);
        }
        see(seen, region, p);
        farthest = fmax(farthest, sqrt(seen[0] * seen[0] + seen[1] * seen[1]) - seen[2] - region->radius);
    }
    return answer(ends[0], farthest, box->margin);
}

enum tract_answer region_box(const struct region *region, const double low[3], const double high[3])
{
    struct box box;
    double depths[2];
    for (int a = 0; a < 3; a++) {
        box.centre[a] = (low[a] + high[a]) / 2 - region->origin[a];
        box.half[a] = (high[a] - low[a]) / 2;
    }
    box.margin = DOUBT * (vec3_length(region->origin) + vec3_length(box.centre) + vec3_length(box.half));
    if (region->shape == REGION_BALL) {
        return test_ball(region, &box);
    }
    reach(depths, &box, region->axis);
    enum tract_answer range = answer(fmax(region->near - depths[1], depths[0] - region->far),
                                     fmax(region->near - depths[0], depths[1] - region->far), box.margin);
    if (range == TRACT_OUTSIDE) {
        return range;
    }
    enum tract_answer side = region->square ? test_square(region, &box) : test_round(region, &box);
    return side == TRACT_INSIDE ? range : side;
}
