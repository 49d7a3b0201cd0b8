/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns, moves and zooms the eye of the 3-D pane. */
#include "viewer/pictures/orbit.h"

#include <math.h>
#include <string.h>

static const double steepest = 1.55;
static const double field_of_view = 0.5; /* of the pane's shorter side */

void orbit_look_at(struct orbit *orbit, const double centre[3], double radius)
{
    *orbit = (struct orbit){.azimuth = 0.9, .elevation = 0.35, .field_of_view = field_of_view};
    memcpy(orbit->centre, centre, sizeof orbit->centre);
    orbit->distance = 1.08 * radius / sin(orbit->field_of_view / 2);
}

void orbit_fit(struct orbit *orbit, const double size[2])
{
    double slope = tan(field_of_view / 2) * fmax(size[1] / size[0], 1);
    orbit->field_of_view = 2 * atan(slope);
}

/* From the centre towards the eye. */
static void outward(double out[3], const struct orbit *orbit)
{
    out[0] = -sin(orbit->azimuth) * cos(orbit->elevation);
    out[1] = cos(orbit->azimuth) * cos(orbit->elevation);
    out[2] = sin(orbit->elevation);
}

void orbit_camera(conus_pose *out, const struct orbit *orbit)
{
    double z[3];
    double *m = out->world_from_device;
    outward(z, orbit);
    const double x[3] = {-cos(orbit->azimuth), -sin(orbit->azimuth), 0};
    const double y[3] = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]};
    for (int a = 0; a < 3; a++) {
        m[a] = x[a];
        m[4 + a] = y[a];
        m[8 + a] = z[a];
        m[12 + a] = orbit->centre[a] + orbit->distance * z[a];
    }
    m[3] = m[7] = m[11] = 0;
    m[15] = 1;
}

void orbit_turn(struct orbit *orbit, double right, double down, double height)
{
    double step = 3.5 / height;
    orbit->azimuth = remainder(orbit->azimuth + right * step, 2 * M_PI);
    orbit->elevation = fmin(fmax(orbit->elevation + down * step, -steepest), steepest);
}

/* mm per pixel in the plane of the centre. */
static double scale_of(const struct orbit *orbit, double height)
{
    return 2 * orbit->distance * tan(orbit->field_of_view / 2) / height;
}

void orbit_pan(struct orbit *orbit, double right, double down, double height)
{
    conus_pose camera;
    double scale = scale_of(orbit, height);
    orbit_camera(&camera, orbit);
    for (int a = 0; a < 3; a++) {
        orbit->centre[a] += scale * (down * camera.world_from_device[4 + a] - right * camera.world_from_device[a]);
    }
}

void orbit_zoom(struct orbit *orbit, double clicks)
{
    orbit->distance = fmin(fmax(orbit->distance * pow(0.9, clicks), 1), 1e5);
}
