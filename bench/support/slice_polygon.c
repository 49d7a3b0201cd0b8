/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts a box with a plane across the view. */
#include "bench/support/slice_polygon.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Puts the points in order around their middle. */
static void sort_around(double (*points)[2], size_t count)
{
    double middle[2] = {0, 0};
    for (size_t i = 0; i < count; i++) {
        middle[0] += points[i][0] / (double)count;
        middle[1] += points[i][1] / (double)count;
    }
    for (size_t i = 1; i < count; i++) {
        for (size_t k = i; k > 0; k--) {
            double a = atan2(points[k - 1][1] - middle[1], points[k - 1][0] - middle[0]);
            double b = atan2(points[k][1] - middle[1], points[k][0] - middle[0]);
            if (a <= b) {
                break;
            }
            double swap[2] = {points[k][0], points[k][1]};
            memcpy(points[k], points[k - 1], sizeof swap);
            memcpy(points[k - 1], swap, sizeof swap);
        }
    }
}

bool slice_polygon(double out[SLICE_CORNERS][2], const struct slice_box *box, double depth)
{
    double points[12][2];
    size_t count = 0;
    for (int n = 0; n < 8; n++) {
        for (int a = 0; a < 3; a++) {
            const double *p = box->corners[n];
            const double *q = box->corners[n | 1 << a];
            if (!(n >> a & 1) && (p[2] < depth) != (q[2] < depth)) {
                double part = (depth - p[2]) / (q[2] - p[2]);
                points[count][0] = p[0] + part * (q[0] - p[0]);
                points[count][1] = p[1] + part * (q[1] - p[1]);
                count++;
            }
        }
    }
    sort_around(points, count);
    for (size_t i = 0; i < SLICE_CORNERS && count; i++) {
        memcpy(out[i], points[i < count ? i : count - 1], sizeof out[i]);
    }
    return count > 0;
}
