/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts steps, with room for their rounding. */
#include "options/options.h"

#include <math.h>

size_t angles_count(const double range[3])
{
    double steps = floor((range[1] - range[0]) / range[2] * (1 + 1e-12));
    if (!(range[1] >= range[0]) || !(range[2] > 0)) {
        return 0;
    }
    return steps < ANGLE_LIMIT ? (size_t)steps + 1 : ANGLE_LIMIT + 1;
}

double angles_at(const double range[3], size_t index)
{
    return range[0] + (double)index * range[2];
}
