/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves and turns of a pose in its own frame. */
#include "viewer/devices/steer.h"

#include <math.h>
#include <string.h>

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Rodrigues' rotation about a unit vector; column-major, 3 x 3. */
static void rotation(double out[9], const double axis[3], double angle)
{
    double c = cos(angle);
    double s = sin(angle);
    const double cross[9] = {0, axis[2], -axis[1], -axis[2], 0, axis[0], axis[1], -axis[0], 0};
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++) {
            out[3 * column + row] =
                c * (row == column) + (1 - c) * axis[row] * axis[column] + s * cross[3 * column + row];
        }
    }
}

/* Unit columns, perpendicular to each other, that turn right; z, the axis, keeps its direction. */
static void straighten(double m[16])
{
    double *x = m;
    double *y = m + 4;
    double *z = m + 8;
    double size = length(z);
    double along = 0;
    for (int a = 0; a < 3; a++) {
        z[a] /= size;
        along += y[a] * z[a];
    }
    for (int a = 0; a < 3; a++) {
        y[a] -= along * z[a];
    }
    size = length(y);
    for (int a = 0; a < 3; a++) {
        y[a] /= size;
    }
    for (int a = 0; a < 3; a++) {
        x[a] = y[(a + 1) % 3] * z[(a + 2) % 3] - y[(a + 2) % 3] * z[(a + 1) % 3];
    }
}

void steer_pose(conus_pose *pose, const double move[3], const double turn[3])
{
    double *m = pose->world_from_device;
    double angle = length(turn);
    for (int a = 0; a < 3; a++) {
        m[12 + a] += move[0] * m[a] + move[1] * m[4 + a] + move[2] * m[8 + a];
    }
    if (angle > 0) {
        double before[16];
        double by[9];
        rotation(by, (const double[]){turn[0] / angle, turn[1] / angle, turn[2] / angle}, angle);
        memcpy(before, m, sizeof before);
        for (int column = 0; column < 3; column++) {
            for (int row = 0; row < 3; row++) {
                m[4 * column + row] = before[row] * by[3 * column] + before[4 + row] * by[3 * column + 1] +
                                      before[8 + row] * by[3 * column + 2];
            }
        }
        straighten(m);
    }
}

void steer_within(conus_pose *pose, const double centre[3], double radius)
{
    double *at = pose->world_from_device + 12;
    const double offset[3] = {at[0] - centre[0], at[1] - centre[1], at[2] - centre[2]};
    double far = length(offset);
    for (int a = 0; a < 3 && far > radius; a++) {
        at[a] = centre[a] + offset[a] * radius / far;
    }
}
