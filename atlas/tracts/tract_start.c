/* SPDX-License-Identifier: BSD-3-Clause */
/* Moves a ray to the border of a tractogram, in double, and converts it to single precision. */
#include "atlas/tracts/tract_node.h"

#include "base/geometry/math3.h"

/* A ray that moves by less than this along an axis, mm per mm, does not move along it as far as boxes are concerned. */
#define STILL 1e-20

/* Relative to the ray's distance from 0: far above any rounding in double precision. */
#define FAR_SLACK 1e-12

/* The interval of the ray in the box around all capsules; false if it misses. By slabs. */
static bool is_in_bounds(double interval[2], const struct tractogram *tractogram, double grown, const double origin[3],
                         const double direction[3])
{
    interval[0] = 0;
    interval[1] = INFINITY;
    for (int a = 0; a < 3; a++) {
        double low = tractogram->low[a] - grown - origin[a];
        double high = tractogram->high[a] + grown - origin[a];
        double inverse = fabs(direction[a]) > STILL ? 1 / direction[a] : 1 / STILL;
        interval[0] = fmax(interval[0], fmin(low * inverse, high * inverse));
        interval[1] = fmin(interval[1], fmax(low * inverse, high * inverse));
    }
    return interval[0] <= interval[1];
}

bool tract_start_find(struct tract_start *out, const struct tractogram *tractogram, const double origin[3],
                      const double direction[3])
{
    double reach = 0;
    double away = 0;
    double interval[2];
    if (!tractogram->tree.run_count) {
        return false;
    }
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(tractogram->low[a]), fabs(tractogram->high[a])));
        away = fmax(away, fabs(origin[a]));
    }
    out->radius = (float)tractogram->radius;
    out->slack = (float)(TRACT_SLACK * (reach + tractogram->radius) + FAR_SLACK * away);
    if (!is_in_bounds(interval, tractogram, (double)out->radius + (double)out->slack, origin, direction)) {
        return false;
    }
    out->along = interval[0];
    for (int a = 0; a < 3; a++) {
        out->origin[a] = (float)(origin[a] + out->along * direction[a]);
        out->direction[a] = (float)direction[a];
        out->inverse[a] = (float)(fabs(direction[a]) > STILL ? 1 / direction[a] : 1 / STILL);
    }
    return true;
}
