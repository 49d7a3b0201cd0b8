/* SPDX-License-Identifier: BSD-3-Clause */
/* The cone or the ball as a region of space, and its bounds in a grid. */
#include "selection/region/region.h"

#include "base/geometry/math3.h"

/* How far, in voxels, bounds reach beyond what is exact. */
static const double SLACK = 0.01;
/* More than any depth is rounded by, as a part of the coordinates' size. */
static const double ROUNDING = 1e-12;

void region_from_cone(struct region *out, const struct cone *cone)
{
    const double *m = cone->pose.world_from_device;
    *out = (struct region){.shape = cone->radius > 0 ? REGION_CYLINDER : REGION_CONE,
                           .square = cone->aperture == CONUS_APERTURE_SQUARE,
                           .radius = cone->radius,
                           .near = cone->range[0],
                           .far = cone_has_range(cone) ? cone->range[1] : INFINITY};
    for (int a = 0; a < 3; a++) {
        out->right[a] = m[a];
        out->up[a] = m[4 + a];
        out->axis[a] = -m[8 + a];
        out->origin[a] = m[12 + a];
    }
    out->slope = cone_slope(cone); /* a cylinder's angle is 0 */
    sine_cosine(&out->sine, &out->cosine, cone->angle / 2);
}

void region_ball(struct region *out, const double centre[3], double radius)
{
    *out = (struct region){.shape = REGION_BALL, .radius = radius, .near = -INFINITY, .far = INFINITY};
    memcpy(out->origin, centre, sizeof out->origin);
}

bool region_has(const struct region *region, const double point[3])
{
    double v[3];
    vec3_sub(v, point, region->origin);
    if (region->shape == REGION_BALL) {
        return vec3_dot(v, v) <= region->radius * region->radius;
    }
    double x = vec3_dot(v, region->right);
    double y = vec3_dot(v, region->up);
    double z = vec3_dot(v, region->axis);
    double rim = region->shape == REGION_CONE ? region->slope * z : region->radius;
    if (!(z >= region->near && z <= region->far)) {
        return false;
    }
    return region->square ? fabs(x) <= rim && fabs(y) <= rim : x * x + y * y <= rim * rim;
}

/* fmax() and fmin() would be slower, since they care for NaN. */
static void raise_low(double interval[2], double low)
{
    interval[0] = low > interval[0] ? low : interval[0];
}

static void lower_high(double interval[2], double high)
{
    interval[1] = high < interval[1] ? high : interval[1];
}

/* Cuts the interval to a + b t >= 0; `per` is 1 / b. */
static bool clip_half(double interval[2], double a, double b, double per)
{
    if (b > 0) {
        raise_low(interval, -a * per);
    } else if (b < 0) {
        lower_high(interval, -a * per);
    } else if (a < 0) {
        return false;
    }
    return interval[0] <= interval[1];
}

/* Least and greatest depth of the grid's voxels, within the region's; a little more, for what is rounded. */
static void bound_depth(double depth[2], const struct region *region, const struct volume *volume)
{
    depth[0] = INFINITY;
    depth[1] = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = corner >> a & 1 ? (double)(volume->info.dim[a] - 1) : 0;
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        double slack = ROUNDING * (vec3_length(p) + vec3_length(region->origin));
        vec3_sub(p, p, region->origin);
        double z = vec3_dot(p, region->axis);
        depth[0] = fmin(depth[0], z - slack);
        depth[1] = fmax(depth[1], z + slack);
    }
    depth[0] = fmax(depth[0], region->near);
    depth[1] = fmin(depth[1], region->far);
}

void region_bounds_init(struct region_bounds *out, const struct region *region, const struct volume *volume)
{
    const double *m = volume->voxel_from_world;
    double origin[3];
    *out = (struct region_bounds){.rim = {region->radius, region->slope}};
    mat4_point(origin, m, region->origin);
    for (int a = 0; a < 3; a++) {
        const double g[3] = {m[a], m[4 + a], m[8 + a]};
        double x = vec3_dot(g, region->right);
        double y = vec3_dot(g, region->up);
        out->along[a].centre[0] = origin[a];
        out->along[a].centre[1] = vec3_dot(g, region->axis);
        out->along[a].spread = region->shape == REGION_BALL ? vec3_length(g)
                               : region->square             ? fabs(x) + fabs(y)
                                                            : sqrt(x * x + y * y);
    }
    if (region->shape != REGION_BALL) {
        bound_depth(out->depth, region, volume);
    }
}

bool region_bounds_plane(double depth[2], const struct region_bounds *bounds, int axis, double index)
{
    const double *centre = bounds->along[axis].centre;
    double reach[2] = {SLACK + bounds->along[axis].spread * bounds->rim[0],
                       bounds->along[axis].spread * bounds->rim[1]};
    return clip_half(depth, reach[0] + centre[0] - index, reach[1] + centre[1], 1 / (reach[1] + centre[1])) &&
           clip_half(depth, reach[0] - centre[0] + index, reach[1] - centre[1], 1 / (reach[1] - centre[1]));
}

bool region_bounds_range(size_t out[2], const struct region_bounds *bounds, int axis, const double depth[2], size_t dim)
{
    double hull[2] = {INFINITY, -INFINITY};
    double range[2] = {0, (double)dim - 1};
    for (int end = 0; end < 2; end++) {
        double centre = bounds->along[axis].centre[0] + bounds->along[axis].centre[1] * depth[end];
        double reach = SLACK + bounds->along[axis].spread * (bounds->rim[0] + bounds->rim[1] * depth[end]);
        hull[0] = centre - reach < hull[0] ? centre - reach : hull[0];
        hull[1] = centre + reach > hull[1] ? centre + reach : hull[1];
    }
    raise_low(range, ceil(hull[0]));
    lower_high(range, floor(hull[1]));
    if (!(range[0] <= range[1])) {
        return false;
    }
    out[0] = (size_t)range[0];
    out[1] = (size_t)range[1];
    return true;
}
