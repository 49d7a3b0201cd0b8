/* SPDX-License-Identifier: BSD-3-Clause */
/* Projections between a picture and the world. */
#include "viewer/pictures/sight.h"

#include <math.h>

bool sight_is_same(const struct sight *a, const struct sight *b)
{
    bool same = true;
    for (int i = 0; i < 16; i++) {
        same = same && a->camera.world_from_device[i] == b->camera.world_from_device[i];
    }
    for (int i = 0; i < 4; i++) {
        same = same && a->frustum[i] == b->frustum[i];
    }
    return same;
}

void sight_fit(struct sight *sight, const double size[2])
{
    double *f = sight->frustum;
    double middle = (f[0] + f[1]) / 2;
    double half = (f[3] - f[2]) / 2 * size[0] / size[1];
    f[0] = middle - half;
    f[1] = middle + half;
}

void sight_of_orbit(struct sight *out, const struct orbit *orbit, const double size[2])
{
    double slope = tan(orbit->field_of_view / 2);
    *out = (struct sight){.frustum = {0, 0, -slope, slope}};
    orbit_camera(&out->camera, orbit);
    sight_fit(out, size);
}

bool sight_project(double out[2], const struct sight *sight, const double size[2], const double p[3])
{
    const double *m = sight->camera.world_from_device;
    const double *f = sight->frustum;
    double place[3] = {0};
    for (int axis = 0; axis < 3; axis++) {
        for (int a = 0; a < 3; a++) {
            place[axis] += (p[a] - m[12 + a]) * m[4 * axis + a];
        }
    }
    if (!(place[2] < -0.01)) {
        return false;
    }
    out[0] = size[0] * (place[0] / -place[2] - f[0]) / (f[1] - f[0]);
    out[1] = size[1] * (f[3] - place[1] / -place[2]) / (f[3] - f[2]);
    return true;
}

void sight_ray(double direction[3], const struct sight *sight, const double size[2], const double at[2])
{
    const double *m = sight->camera.world_from_device;
    const double *f = sight->frustum;
    double right = f[0] + at[0] / size[0] * (f[1] - f[0]);
    double up = f[3] - at[1] / size[1] * (f[3] - f[2]);
    double scale = 1 / sqrt(right * right + up * up + 1);
    for (int a = 0; a < 3; a++) {
        direction[a] = scale * (right * m[a] + up * m[4 + a] - m[8 + a]);
    }
}
