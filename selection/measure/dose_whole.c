/* SPDX-License-Identifier: BSD-3-Clause */
/* Integrals of weights over whole regions (Eq. 33), by products of Gauss's rules. */
#include "base/geometry/math3.h"
#include "selection/measure/parts.h"

#include <math.h>

enum { MOST_PANELS = 4096, LEVEL_PANELS = 256 };

/* A cross-section of a region, or a ball. */
struct slice {
    const conus_weight *weight;
    double level; /* W counts as 1 from here on, below as 0; NaN: as it is */
    double z;
    bool by_angle; /* x is an angle, of which the distance from the axis is z tan x */
    int power;     /* of the distance r in the measure r^power dr: 1, of a ball 2 */
};

static double radius_of(const struct slice *slice, double x)
{
    return slice->by_angle ? slice->z * tan(radians_from_degrees(x)) : x;
}

static double x_of(const struct slice *slice, double r)
{
    return slice->by_angle ? degrees_from_radians(atan2(r, slice->z)) : r;
}

static double value_at(const struct slice *slice, double r)
{
    return weight_value(slice->weight, x_of(slice, r), slice->z);
}

/* The integral of r^power from a to b. */
static double measure_between(const struct slice *slice, double a, double b)
{
    return slice->power == 1 ? (b * b - a * a) / 2 : (b * b * b - a * a * a) / 3;
}

/* Where between a and b, at one of which only W is the level or more, it becomes that. */
static double cross(const struct slice *slice, double a, double b)
{
    const bool above = value_at(slice, a) >= slice->level;
    for (int i = 0; i < 48; i++) {
        const double middle = (a + b) / 2;
        *((value_at(slice, middle) >= slice->level) == above ? &a : &b) = middle;
    }
    return (a + b) / 2;
}

/* From a to b, between which W is smooth, and rises or falls all the way. */
static double panel(const struct slice *slice, double a, double b)
{
    double sum = 0;
    if (isnan(slice->level)) {
        for (size_t i = 0; i < GAUSS_POINTS; i++) {
            const double r = a + gauss_rule[i].at * (b - a);
            sum += gauss_rule[i].weight * value_at(slice, r) * (slice->power == 1 ? r : r * r);
        }
        return sum * (b - a);
    }
    const bool above[] = {value_at(slice, a) >= slice->level, value_at(slice, b) >= slice->level};
    if (above[0] == above[1]) {
        return above[0] ? measure_between(slice, a, b) : 0;
    }
    const double middle = cross(slice, a, b);
    return above[0] ? measure_between(slice, a, middle) : measure_between(slice, middle, b);
}

/* From the middle to `rim`: between a table's rows, or in panels of the shortest length. */
static double radial(const struct slice *slice, double rim)
{
    const conus_weight *weight = slice->weight;
    double sum = 0;
    double from = 0;
    for (size_t i = 0; weight->at && i < weight->counts[0] && from < rim; i++) {
        const double to = fmin(radius_of(slice, weight->at[i]), rim);
        sum += to > from ? panel(slice, from, to) : 0;
        from = fmax(from, to);
    }
    if (!weight->at) {
        const double panels = fmin(ceil(rim / weight_finest(weight, slice->z)), MOST_PANELS);
        const size_t count = panels > 1 ? (size_t)panels : 1;
        for (size_t i = 0; i < count; i++) {
            sum += panel(slice, rim * (double)i / (double)count, rim * (double)(i + 1) / (double)count);
        }
    }
    return sum;
}

/* A cross-section: a circle, or a square, whose sides are 1 / cos(angle) away from the middle in eight like parts. */
static double over_slice(const struct slice *slice, double rim, bool square)
{
    enum { PARTS = 4 };
    const double eighth = MATH3_PI / 4;
    double sum = 0;
    for (size_t part = 0; square && part < PARTS; part++) {
        for (size_t i = 0; i < GAUSS_POINTS; i++) {
            const double angle = eighth * ((double)part + gauss_rule[i].at) / PARTS;
            sum += 8 * eighth / PARTS * gauss_rule[i].weight * radial(slice, rim / cos(angle));
        }
    }
    return square ? sum : 2 * MATH3_PI * radial(slice, rim);
}

static double over_depths(const struct slice *given, const struct region *region, double from, double to)
{
    struct slice slice = *given;
    double sum = 0;
    for (size_t i = 0; i < GAUSS_POINTS; i++) {
        slice.z = from + gauss_rule[i].at * (to - from);
        const double rim = region->shape == REGION_CONE ? region->slope * slice.z : region->radius;
        sum += gauss_rule[i].weight * over_slice(&slice, rim, region->square);
    }
    return sum * (to - from);
}

/* Between two depths where W is smooth, in panels of the shortest length, or more where it is cut at a level, of which
 * there are `LEVEL_PANELS` in the length `all`. */
static double over_range(const struct slice *slice, const struct region *region, double from, double to, double all)
{
    const conus_weight *weight = slice->weight;
    const double length = fmin(weight->finest[1], isnan(slice->level) ? INFINITY : all / LEVEL_PANELS);
    const double panels = weight->at && isnan(slice->level) ? 1 : fmin(ceil((to - from) / length), MOST_PANELS);
    const double step = (to - from) / panels;
    double sum = 0;
    for (size_t i = 0; i < (size_t)panels; i++) {
        sum += over_depths(slice, region, from + step * (double)i, from + step * (double)(i + 1));
    }
    return sum;
}

/* W that depends on the depth. */
static double by_depth(const struct slice *slice, const struct region *region)
{
    const conus_weight *weight = slice->weight;
    double sum = 0;
    if (!weight->at) {
        return over_range(slice, region, region->near, region->far, region->far - region->near);
    }
    const double *depth = weight->at + weight->counts[0];
    const double all = fmin(depth[weight->counts[1] - 1], region->far) - fmax(depth[0], region->near);
    for (size_t k = 1; k < weight->counts[1]; k++) {
        const double from = fmax(depth[k - 1], region->near);
        const double to = fmin(depth[k], region->far);
        sum += from < to ? over_range(slice, region, from, to, all) : 0;
    }
    return sum;
}

double dose_whole(const conus_weight *weight, const struct region *region, double level)
{
    struct slice slice = {
        .weight = weight, .level = level, .z = 1, .by_angle = weight->facts.by == WEIGHT_BY_ANGLE, .power = 1};
    const double near = region->near;
    const double far = region->far;
    if (region->shape == REGION_BALL) {
        slice.power = 2;
        return 4 * MATH3_PI * radial(&slice, region->radius);
    }
    if (weight->facts.by_depth) {
        return isinf(far) ? INFINITY : by_depth(&slice, region);
    }
    if (region->shape == REGION_CYLINDER) {
        return over_slice(&slice, region->radius, region->square) * (far - near);
    }
    return over_slice(&slice, region->slope, region->square) * ((far * far * far - near * near * near) / 3);
}

double dose_largest(const conus_weight *weight, const struct region *region)
{
    const double widest = region->square ? sqrt(2) : 1;
    const double angle = degrees_from_radians(atan(widest * region->slope));
    const bool is_cone = region->shape == REGION_CONE;
    const double rim[] = {is_cone ? weight->facts.by == WEIGHT_BY_ANGLE ? angle : 0 : widest * region->radius,
                          is_cone && weight->facts.by != WEIGHT_BY_ANGLE ? widest * region->slope : 0};
    const double all[] = {0, INFINITY};
    return weight_largest(weight, rim,
                          region->shape == REGION_BALL ? all : (const double[]){region->near, region->far});
}
