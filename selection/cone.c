/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/cone.h"

#include "base/math3.h"

enum { RESOLUTION_LIMIT = 1024 };

conus_status cone_check(const struct cone *cone)
{
    if (!(cone->angle > 0 && cone->angle < MATH3_PI)) {
        return fail(CONUS_ERROR_ARGUMENT, "angle: %g degrees, allowed is more than 0 and less than 180",
                    degrees_from_radians(cone->angle));
    }
    if (cone->resolution < 1 || cone->resolution > RESOLUTION_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "resolution: %u, allowed is 1 to %d", cone->resolution, RESOLUTION_LIMIT);
    }
    return CONUS_OK;
}

void cone_ray_at(double out[3], const struct cone *cone, double slope, uint32_t i, uint32_t j)
{
    double in_device[3] = {cone_coordinate(i, cone->resolution) * slope, cone_coordinate(j, cone->resolution) * slope,
                           -1};
    vec3_scale(in_device, in_device, 1 / vec3_length(in_device));
    mat4_direction(out, cone->pose.world_from_device, in_device);
}

void cone_ray(double out[3], const struct cone *cone, uint32_t i, uint32_t j)
{
    cone_ray_at(out, cone, tan(cone->angle / 2), i, j);
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
    double slope = tan(cone->angle / 2) * cone_radius(cone, i, j);
    return pow(1 + slope * slope, -1.5);
}
