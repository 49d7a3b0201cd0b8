/* SPDX-License-Identifier: BSD-3-Clause */
/* Fits a power law. */
#include "bench/growth/exponent.h"

#include <math.h>

double growth_exponent(const double *x, const double *y, size_t count)
{
    double mean_x = 0;
    double mean_y = 0;
    double above = 0;
    double below = 0;
    for (size_t i = 0; i < count; i++) {
        mean_x += log(x[i]) / (double)count;
        mean_y += log(y[i]) / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        double away = log(x[i]) - mean_x;
        above += away * (log(y[i]) - mean_y);
        below += away * away;
    }
    return below > 0 ? above / below : (double)NAN;
}
