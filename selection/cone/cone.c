/* SPDX-License-Identifier: BSD-3-Clause */
/* The rays of a cone, a pyramid or a cylinder, and the checks of its numbers. */
#include "selection/cone/cone.h"

#include "base/geometry/math3.h"
#include "poses/rows/pose_row.h"

#include <string.h>

/* Up to here the rays are a perspective picture's, on whose axis a pixel then covers three times the mean solid angle
 * (Eq. 15). A billionth more, so that 120 degrees stay what they are, however they were rounded. */
static const double perspective_limit = 2 * MATH3_PI / 3 + 1e-9;

enum { RESOLUTION_LIMIT = 1024, RAYS_AT_ONCE = 256 };

conus_status cone_check(const struct cone *cone)
{
    if (!(cone->radius >= 0 && isfinite(cone->radius))) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, allowed is more than 0", cone->radius);
    }
    if (cone->radius > 0 && !(cone->degrees == 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "angle: %g degrees with a radius: a cylinder has angle 0", cone->degrees);
    }
    conus_status status = cone->radius > 0 ? CONUS_OK : pose_check_angle(cone->degrees);
    if (!status && (cone->range[0] != 0 || cone->range[1] != 0)) {
        status = pose_check_range(cone->range);
    }
    if (!status && (cone->resolution < 1 || cone->resolution > RESOLUTION_LIMIT)) {
        status = fail(CONUS_ERROR_ARGUMENT, "resolution: %u, allowed is 1 to %d", cone->resolution, RESOLUTION_LIMIT);
    }
    return status;
}

double cone_slope(const struct cone *cone)
{
    return cone->slope > 0 ? cone->slope : tangent(cone->angle / 2);
}

bool cone_is_wide(const struct cone *cone)
{
    return cone->angle > perspective_limit;
}

double cone_off_axis(const struct cone *cone, double radius)
{
    return cone_is_wide(cone) ? radius * (cone->angle / 2) : arc_tangent(radius * cone_slope(cone), 1);
}

static void aim_in_perspective(double *right, double *up, double *forward, double slope, const double *u,
                               const double *v, size_t count)
{
    for (size_t ray = 0; ray < count; ray++) {
        double x = u[ray] * slope;
        double y = v[ray] * slope;
        double scale = 1 / sqrt(x * x + y * y + 1);
        right[ray] = x * scale;
        up[ray] = y * scale;
        forward[ray] = scale;
    }
}

/* Eq. 15 */
static void aim_evenly(double *right, double *up, double *forward, double half, const double *u, const double *v,
                       size_t count)
{
    for (size_t ray = 0; ray < count; ray++) {
        double r = sqrt(u[ray] * u[ray] + v[ray] * v[ray]);
        double scale = r > 0 ? sine_of(r * half) / r : 0;
        right[ray] = u[ray] * scale;
        up[ray] = v[ray] * scale;
        forward[ray] = cosine_of(r * half);
    }
}

void cone_device_rays(double *right, double *up, double *forward, const struct cone *cone, const double *u,
                      const double *v, size_t count)
{
    if (cone_is_wide(cone)) {
        aim_evenly(right, up, forward, cone->angle / 2, u, v, count);
    } else {
        aim_in_perspective(right, up, forward, cone_slope(cone), u, v, count);
    }
}

void cone_rays_from(double *const out[3], const struct cone *cone, const struct device_rays *rays, size_t first,
                    size_t count)
{
    double m[16]; /* on its own, or the compiler fears that the results overwrite it and does not vectorise */
    const double *right = rays->right + first;
    const double *up = rays->up + first;
    const double *forward = rays->forward + first;
    memcpy(m, cone->pose.world_from_device, sizeof m);
    for (int a = 0; a < 3; a++) {
        double *axis = out[a];
        for (size_t ray = 0; ray < count; ray++) {
            axis[ray] = m[a] * right[ray] + m[4 + a] * up[ray] - m[8 + a] * forward[ray];
        }
    }
}

void cone_rays(double *const out[3], const struct cone *cone, const double *u, const double *v, size_t count)
{
    double right[RAYS_AT_ONCE];
    double up[RAYS_AT_ONCE];
    double forward[RAYS_AT_ONCE];
    const struct device_rays rays = {.right = right, .up = up, .forward = forward};
    for (size_t first = 0; first < count; first += RAYS_AT_ONCE) {
        double *const part[3] = {out[0] + first, out[1] + first, out[2] + first};
        size_t some = count - first < RAYS_AT_ONCE ? count - first : RAYS_AT_ONCE;
        cone_device_rays(right, up, forward, cone, u + first, v + first, some);
        cone_rays_from(part, cone, &rays, 0, some);
    }
}

void cone_ray(double out[3], const struct cone *cone, uint32_t i, uint32_t j)
{
    double *const axes[3] = {&out[0], &out[1], &out[2]};
    double u = cone_coordinate(i, cone->resolution);
    double v = cone_coordinate(j, cone->resolution);
    cone_rays(axes, cone, &u, &v, 1);
}

void cone_origin(double out[3], const struct cone *cone, uint32_t i, uint32_t j)
{
    const double *m = cone->pose.world_from_device;
    memcpy(out, m + 12, 3 * sizeof *out);
    if (cone->radius > 0) {
        vec3_add_scaled(out, out, cone_coordinate(i, cone->resolution) * cone->radius, m);
        vec3_add_scaled(out, out, cone_coordinate(j, cone->resolution) * cone->radius, m + 4);
    }
}

void cone_point(double out[3], const struct cone *cone, uint32_t i, uint32_t j, double distance)
{
    double ray[3];
    cone_ray(ray, cone, i, j);
    cone_origin(out, cone, i, j);
    vec3_add_scaled(out, out, distance, ray);
}

double cone_per_depth(const struct cone *cone, uint32_t i, uint32_t j)
{
    if (cone->tracing.per_depth) {
        return cone->tracing.per_depth[(size_t)j * cone->resolution + i];
    }
    double radius = cone_radius(cone, i, j);
    double slope = cone_slope(cone) * radius;
    return cone_is_wide(cone) ? 1 / cosine_of(cone_off_axis(cone, radius)) : sqrt(1 + slope * slope);
}

double cone_cross_section(const struct cone *cone)
{
    bool square = cone->aperture == CONUS_APERTURE_SQUARE;
    double sine;
    double cosine;
    sine_cosine(&sine, &cosine, cone->angle / 2);
    if (cone->radius > 0) {
        return (square ? 4 : MATH3_PI) * cone->radius * cone->radius;
    }
    return square ? 4 * arc_tangent(sine * sine, cosine * sqrt(1 + sine * sine)) : 2 * MATH3_PI * (1 - cosine);
}

double cone_radius(const struct cone *cone, uint32_t i, uint32_t j)
{
    return cone_radius_of(cone_square(i, j, cone->resolution), cone->resolution);
}

/* Whether a wide cone's ray is in the pyramid, whose sides are as far off the axis as the cone. */
static bool is_in_pyramid(const struct cone *cone, uint32_t i, uint32_t j)
{
    double r = cone_radius(cone, i, j);
    double off = cone_off_axis(cone, r);
    double side = fmax(fabs(2.0 * i + 1 - cone->resolution), fabs(2.0 * j + 1 - cone->resolution)) / cone->resolution;
    return off < MATH3_PI / 2 && side * tangent(off) <= r * cone_slope(cone);
}

bool cone_has_pixel(const struct cone *cone, uint32_t i, uint32_t j)
{
    if (cone->aperture == CONUS_APERTURE_SQUARE) {
        return !cone_is_wide(cone) || is_in_pyramid(cone, i, j);
    }
    return cone_square(i, j, cone->resolution) <= cone->resolution * cone->resolution;
}

double cone_weight(const struct cone *cone, uint32_t i, uint32_t j)
{
    double radius = cone_radius(cone, i, j);
    double slope = cone_slope(cone) * radius;
    double square = 1 + slope * slope;
    double off = cone_off_axis(cone, radius);
    return !cone_is_wide(cone) ? 1 / (square * sqrt(square)) : off > 0 ? sine_of(off) / off : 1;
}
