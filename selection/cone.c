/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/cone.h"

#include "base/math3.h"

#include <string.h>

enum { RESOLUTION_LIMIT = 1024 };

static conus_status check_shape(const struct cone *cone)
{
    double angle = degrees_from_radians(cone->angle);
    if (!(cone->radius >= 0 && isfinite(cone->radius))) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, allowed is more than 0", cone->radius);
    }
    if (cone->radius > 0 && !(cone->angle == 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "angle: %g degrees with a radius: a cylinder has angle 0", angle);
    }
    if (cone->radius == 0 && !(cone->angle > 0 && cone->angle < MATH3_PI)) {
        return fail(CONUS_ERROR_ARGUMENT, "angle: %g degrees, allowed is more than 0 and less than 180%s", angle,
                    cone->angle == 0 ? "; 0 needs a radius" : "");
    }
    const double *range = cone->range;
    if ((range[0] != 0 || range[1] != 0) && !(range[0] >= 0 && range[1] > range[0] && isfinite(range[1]))) {
        return fail(CONUS_ERROR_ARGUMENT, "range: %g to %g mm, allowed is NEAR from 0 on and FAR beyond it", range[0],
                    range[1]);
    }
    return CONUS_OK;
}

conus_status cone_check(const struct cone *cone)
{
    conus_status status = check_shape(cone);
    if (status) {
        return status;
    }
    if (cone->resolution < 1 || cone->resolution > RESOLUTION_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "resolution: %u, allowed is 1 to %d", cone->resolution, RESOLUTION_LIMIT);
    }
    return CONUS_OK;
}

double cone_slope(const struct cone *cone)
{
    return cone->slope > 0 ? cone->slope : tan(cone->angle / 2);
}

void cone_rays(double *const out[3], const struct cone *cone, const double *u, const double *v, size_t count)
{
    double m[16]; /* on its own, or the compiler fears that the results overwrite it and does not vectorise */
    double slope = cone_slope(cone);
    double *x = out[0];
    double *y = out[1];
    double *z = out[2];
    memcpy(m, cone->pose.world_from_device, sizeof m);
    for (size_t ray = 0; ray < count; ray++) {
        double right = u[ray] * slope;
        double up = v[ray] * slope;
        double scale = 1 / sqrt(right * right + up * up + 1);
        right *= scale;
        up *= scale;
        x[ray] = m[0] * right + m[4] * up - m[8] * scale;
        y[ray] = m[1] * right + m[5] * up - m[9] * scale;
        z[ray] = m[2] * right + m[6] * up - m[10] * scale;
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

double cone_per_depth(const struct cone *cone, uint32_t i, uint32_t j)
{
    double slope = cone_slope(cone) * cone_radius(cone, i, j);
    return sqrt(1 + slope * slope);
}

double cone_cross_section(const struct cone *cone)
{
    bool square = cone->aperture == CONUS_SQUARE;
    double sine = sin(cone->angle / 2);
    if (cone->radius > 0) {
        return (square ? 4 : MATH3_PI) * cone->radius * cone->radius;
    }
    return square ? 4 * asin(sine * sine) : 2 * MATH3_PI * (1 - cos(cone->angle / 2));
}

double cone_radius(const struct cone *cone, uint32_t i, uint32_t j)
{
    double u = cone_coordinate(i, cone->resolution);
    double v = cone_coordinate(j, cone->resolution);
    return sqrt(u * u + v * v);
}

bool cone_has_pixel(const struct cone *cone, uint32_t i, uint32_t j)
{
    return cone->aperture == CONUS_SQUARE || cone_radius(cone, i, j) <= 1;
}

double cone_weight(const struct cone *cone, uint32_t i, uint32_t j)
{
    double slope = cone_slope(cone) * cone_radius(cone, i, j);
    double square = 1 + slope * slope;
    return 1 / (square * sqrt(square));
}
