/* SPDX-License-Identifier: BSD-3-Clause */
/* A line in a capsule: in the balls round its ends, and in the cylinder between them (Eq. 18). */
#include "atlas/tracts/tractogram.h"

#include "base/geometry/math3.h"

/* Half of the chord that a line at the distance `away` from the centre has in a circle, at most a radius. */
static double half_chord(double radius, double away)
{
    return sqrt((radius - away) * (radius + away));
}

/* Finds the line's point that is nearest to `point`, by its place along the line; `out` is from `point` to it. */
static double foot_of(double out[3], const double point[3], const double origin[3], const double direction[3])
{
    vec3_sub(out, origin, point);
    double along = -vec3_dot(out, direction);
    vec3_add_scaled(out, out, along, direction);
    return along;
}

/* Extends the interval by that of a ball; `foot` is measured from its centre. */
static void add_ball(double interval[2], const double foot[3], double along, double radius)
{
    double away = vec3_length(foot);
    if (away <= radius) {
        double half = half_chord(radius, away);
        interval[0] = fmin(interval[0], along - half);
        interval[1] = fmax(interval[1], along + half);
    }
}

/* Clips `interval` to the part of the line in a slab, 0 <= height + t slope <= top. */
static void cut_by_slab(double interval[2], double height, double slope, double top)
{
    if (slope != 0) {
        double ends[2] = {-height / slope, (top - height) / slope};
        interval[0] = fmax(interval[0], fmin(ends[0], ends[1]));
        interval[1] = fmin(interval[1], fmax(ends[0], ends[1]));
    } else if (height < 0 || height > top) {
        interval[1] = -INFINITY;
    }
}

/* Extends the interval by that of a cylinder along the unit @p axis, @p length mm long; `foot` is measured from its
 * beginning. Everything is relative to the foot: where the line hits the cylinder, it is within a radius and a length
 * of the foot. A direction nearly along the axis has few digits across it, but every term has the same ones. So the
 * interval is exact for a line that differs only by rounding. */
static void add_cylinder(double interval[2], const double foot[3], double along, const double direction[3],
                         const double axis[3], double length, double radius)
{
    double height = vec3_dot(foot, axis);
    double slope = vec3_dot(direction, axis);
    double inside[2] = {-INFINITY, INFINITY};
    double across[3]; /* from the axis to the foot */
    double drift[3];  /* how that changes along the line */
    vec3_add_scaled(across, foot, -height, axis);
    vec3_add_scaled(drift, direction, -slope, axis);
    double speed = vec3_length(drift);
    double behind = 0;
    if (speed > 0) {
        vec3_scale(drift, drift, 1 / speed);
        behind = vec3_dot(across, drift);
        vec3_add_scaled(across, across, -behind, drift);
    }
    double away = vec3_length(across); /* of the line from the axis, where they are closest */
    if (!(away <= radius)) {
        return;
    }
    if (speed > 0) {
        double half = half_chord(radius, away);
        inside[0] = (-behind - half) / speed;
        inside[1] = (-behind + half) / speed;
    }
    cut_by_slab(inside, height, slope, length);
    if (inside[0] <= inside[1]) {
        interval[0] = fmin(interval[0], along + inside[0]);
        interval[1] = fmax(interval[1], along + inside[1]);
    }
}

bool capsule_interval(double out[2], const double origin[3], const double direction[3], const double a[3],
                      const double b[3], double radius)
{
    double interval[2] = {INFINITY, -INFINITY};
    double foot[3];
    double axis[3];
    vec3_sub(axis, b, a);
    double length = vec3_length(axis);
    double along = foot_of(foot, b, origin, direction);
    add_ball(interval, foot, along, radius);
    along = foot_of(foot, a, origin, direction);
    add_ball(interval, foot, along, radius);
    if (vec3_normalise(axis, axis)) {
        add_cylinder(interval, foot, along, direction, axis, length, radius);
    }
    if (!(interval[0] <= interval[1])) {
        return false;
    }
    out[0] = interval[0];
    out[1] = interval[1];
    return true;
}
