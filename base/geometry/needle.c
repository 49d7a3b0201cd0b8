/* SPDX-License-Identifier: BSD-3-Clause */
/* Distances of a needle. All are convex along it, and the slope of their squares is linear from one known depth to the
 * next: where it rises to 0 the needle is nearest. */
#include "base/geometry/math3.h"

/* Two directions are parallel where they part by at most so many mm per mm. */
static const double ALONG = 1e-12;

void needle_point(double out[3], const struct needle *needle, double depth)
{
    vec3_add_scaled(out, needle->origin, depth, needle->direction);
}

void needle_frame_init(struct needle_frame *out, const struct needle *needle, const double frame_from_world[16])
{
    double world_from_frame[16];
    mat4_identity(world_from_frame);
    memcpy(out->at, needle->origin, sizeof out->at);
    memcpy(out->step, needle->direction, sizeof out->step);
    if (frame_from_world) {
        mat4_point(out->at, frame_from_world, needle->origin);
        mat4_direction(out->step, frame_from_world, needle->direction);
        mat4_invert_affine(world_from_frame, frame_from_world);
    }
    for (int a = 0; a < 3; a++) {
        out->scale[a] = vec3_length(world_from_frame + 4 * a);
        out->step[a] = fabs(out->step[a]) * out->scale[a] < ALONG ? 0 : out->step[a];
        out->per[a] = out->step[a] != 0 ? 1 / out->step[a] : 0;
        out->square[a] = out->step[a] * out->scale[a] * (out->step[a] * out->scale[a]);
    }
    out->near = needle->near;
    out->far = needle->far;
}

/* A box: along each axis the depths between which the needle is beside it, all where it runs along its sides. */
struct beside {
    double in[3], out[3];
};

/* How far the depth t is from being beside the box, along one axis: negative before it. */
static double beyond(const struct beside *beside, int a, double t)
{
    return t < beside->in[a] ? t - beside->in[a] : t > beside->out[a] ? t - beside->out[a] : 0;
}

/* Half of the slope of the squared distance. */
static double slope_at(const struct beside *beside, const struct needle_frame *frame, double t)
{
    return frame->square[0] * beyond(beside, 0, t) + frame->square[1] * beyond(beside, 1, t) +
           frame->square[2] * beyond(beside, 2, t);
}

/* The least depth whose slope is not negative, or the far end. */
static double nearest_depth(const struct beside *beside, const struct needle_frame *frame)
{
    double low = frame->near;
    double high = frame->far;
    if (slope_at(beside, frame, low) >= 0 || slope_at(beside, frame, high) < 0) {
        return slope_at(beside, frame, low) >= 0 ? low : high;
    }
    for (int i = 0; i < 6; i++) {
        double t = i < 3 ? beside->in[i] : beside->out[i - 3];
        if (t > low && t < high) {
            bool falls = slope_at(beside, frame, t) < 0;
            low = falls ? t : low;
            high = falls ? high : t;
        }
    }
    if (slope_at(beside, frame, high) == 0) {
        return high; /* as where it comes in */
    }
    double middle = low + (high - low) / 2;
    double sum = 0;
    double weight = 0;
    for (int a = 0; a < 3; a++) {
        double side = beyond(beside, a, middle);
        if (side != 0) {
            sum += frame->square[a] * (side < 0 ? beside->in[a] : beside->out[a]);
            weight += frame->square[a];
        }
    }
    double root = sum / weight;
    return root <= low ? low : root < high ? root : high; /* NaN is no place: high */
}

double needle_box(double *depth, const struct needle_frame *frame, const double low[3], const double high[3])
{
    struct beside beside;
    double square = 0;
    for (int a = 0; a < 3; a++) {
        double to_low = (low[a] - frame->at[a]) * frame->per[a];
        double to_high = (high[a] - frame->at[a]) * frame->per[a];
        beside.in[a] = frame->step[a] == 0 ? -INFINITY : to_low < to_high ? to_low : to_high;
        beside.out[a] = frame->step[a] == 0 ? INFINITY : to_low < to_high ? to_high : to_low;
    }
    double t = nearest_depth(&beside, frame);
    for (int a = 0; a < 3; a++) {
        double gap = frame->at[a] < low[a]    ? low[a] - frame->at[a]
                     : frame->at[a] > high[a] ? frame->at[a] - high[a]
                                              : 0;
        gap = frame->step[a] == 0 ? gap : beyond(&beside, a, t) * frame->step[a];
        square += gap * frame->scale[a] * (gap * frame->scale[a]);
    }
    *depth = t;
    return sqrt(square);
}

double needle_segment(double *depth, double point[3], const struct needle *needle, const double a[3], const double b[3])
{
    /* Relative to `a`, and along the needle to where its line is nearest to that: no term is a difference of squares */
    double foot[3];
    double axis[3];
    double across[3];
    double drift[3];
    vec3_sub(foot, needle->origin, a);
    double along = -vec3_dot(foot, needle->direction);
    vec3_add_scaled(foot, foot, along, needle->direction);
    vec3_sub(axis, b, a);
    double length = vec3_length(axis);
    if (length > 0) {
        vec3_scale(axis, axis, 1 / length);
    }
    double height = vec3_dot(foot, axis);
    double climb = vec3_dot(needle->direction, axis);
    vec3_add_scaled(across, foot, -height, axis);
    vec3_add_scaled(drift, needle->direction, -climb, axis);
    double square = vec3_dot(drift, drift);
    /* Where the line is nearest to the axis; everywhere, if it runs along that */
    double between = square > ALONG * ALONG ? -vec3_dot(across, drift) / square : -INFINITY;
    double s;
    if (climb == 0) {
        s = height >= 0 && height <= length ? between : 0;
    } else { /* up to `in` one end of the segment is nearest, from `out` on the other one */
        double in = (climb > 0 ? -height : length - height) / climb;
        double out = (climb > 0 ? length - height : -height) / climb;
        double before = climb > 0 ? 0 : length * climb;
        double after = climb > 0 ? length * climb : 0;
        s = before <= in ? before : between <= in ? in : between <= out ? between : after > out ? after : out;
    }
    double low = needle->near - along;
    double high = needle->far - along;
    s = s <= low ? low : s < high ? s : high;
    double reach = height + s * climb;
    reach = reach < 0 ? 0 : reach > length ? length : reach;
    double away[3];
    for (int i = 0; i < 3; i++) {
        away[i] = foot[i] + s * needle->direction[i] - reach * axis[i];
        point[i] = a[i] + reach * axis[i];
    }
    *depth = s <= low ? needle->near : s >= high ? needle->far : s + along;
    return vec3_length(away);
}
