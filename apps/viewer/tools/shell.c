/* SPDX-License-Identifier: BSD-3-Clause */
/* Rings of a cone's wall, and cuts through the triangles between them. */
#include "viewer/tools/tools.h"

#include "base/geometry/math3.h"

#include <math.h>

/* A point of a ring in the device's frame, whose axis is -z: @p depth mm deep, in the direction (x, y). */
static void put(double out[3], const conus_pose *pose, double x, double y, double radius, double depth)
{
    const double *m = pose->world_from_device;
    for (int a = 0; a < 3; a++) {
        out[a] = m[12 + a] + radius * (x * m[a] + y * m[4 + a]) - depth * m[8 + a];
    }
}

void shell_find(struct shell *out, const conus_pose *pose, double radius, double angle, double near, double far)
{
    double half = angle * (M_PI / 180) / 2;
    double slope = tan(half);
    const double *m = pose->world_from_device;
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        double turn = 2 * M_PI * (double)i / SHELL_POINTS;
        double x = cos(turn);
        double y = sin(turn);
        put(out->near[i], pose, x, y, radius + near * slope, near);
        put(out->far[i], pose, x, y, radius + far * slope, far);
        for (int a = 0; a < 3; a++) {
            out->out[i][a] = cos(half) * (x * m[a] + y * m[4 + a]) + sin(half) * m[8 + a];
        }
    }
}

static size_t cut_triangle(struct shell_piece *out, const double *const corners[3], const double at[3],
                           const double normal[3])
{
    double beside[3];
    size_t found = 0;
    for (int c = 0; c < 3; c++) {
        double offset[3];
        vec3_sub(offset, corners[c], at);
        beside[c] = vec3_dot(offset, normal);
    }
    for (int c = 0; c < 3; c++) {
        int next = (c + 1) % 3;
        if ((beside[c] < 0) == (beside[next] < 0)) {
            continue;
        }
        for (int a = 0; a < 3; a++) { /* where the edge meets the plane */
            out->ends[found][a] =
                corners[c][a] + (corners[next][a] - corners[c][a]) * beside[c] / (beside[c] - beside[next]);
        }
        found++;
    }
    return found == 2;
}

size_t shell_cut(struct shell_piece out[2 * SHELL_POINTS], const struct shell *shell, const double at[3],
                 const double normal[3])
{
    size_t count = 0;
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        size_t next = (i + 1) % SHELL_POINTS;
        const double *const lower[3] = {shell->near[i], shell->far[i], shell->far[next]};
        const double *const upper[3] = {shell->near[i], shell->far[next], shell->near[next]};
        struct shell_piece piece;
        const double *const *const both[2] = {lower, upper};
        for (int t = 0; t < 2; t++) {
            if (cut_triangle(&piece, both[t], at, normal)) {
                out[count++] = piece;
            }
        }
    }
    return count;
}

static bool faces(const struct shell *shell, size_t i, const double eye[3])
{
    double offset[3];
    vec3_sub(offset, eye, shell->far[i]);
    return vec3_dot(shell->out[i], offset) > 0;
}

bool shell_turns(const struct shell *shell, size_t i, const double eye[3])
{
    return faces(shell, i, eye) != faces(shell, (i + 1) % SHELL_POINTS, eye);
}
