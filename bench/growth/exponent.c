/* SPDX-License-Identifier: BSD-3-Clause */
/* Fits a power law. The distances from the mean of log x sum to 0, so that the mean of log y does not matter. */
#include "bench/growth/exponent.h"

#include <math.h>

double growth_exponent(const double *x, const double *y, size_t count)
{
    double mean_x = 0;
    double above = 0;
    double below = 0;
    for (size_t i = 0; i < count; i++) {
        mean_x += log(x[i]) / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        double away = log(x[i]) - mean_x;
        above += away * log(y[i]);
        below += away * away;
    }
    return below > 0 ? above / below : (double)NAN;
}
