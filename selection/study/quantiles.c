/* SPDX-License-Identifier: BSD-3-Clause */
/* Quantiles by halving, of distributions as Abramowitz and Stegun (1964) have them. */
#include "base/geometry/math3.h"
#include "selection/study/study.h"

#include <math.h>
#include <stdbool.h>

enum { HALVINGS = 80 };

/* log Γ(degrees / 2 + 1): of whole and half numbers a sum. */
static double log_gamma_above_half(size_t degrees)
{
    double sum = degrees % 2 ? log(MATH3_PI) / 2 : 0;
    for (size_t twice = degrees; twice > 0; twice -= twice > 1 ? 2 : 1) { /* the last is 2 or 1 */
        sum += log((double)twice / 2);
    }
    return sum;
}

/* P(chi squared < value), by the series 6.5.29: x^a e^-x / Γ(a + 1) (1 + x / (a + 1) + ...), a = degrees / 2, x = value
 * / 2; `log_gamma` is log Γ(a + 1). */
static double below_chi_squared(double value, size_t degrees, double log_gamma)
{
    const double a = (double)degrees / 2;
    const double x = value / 2;
    double sum = 1;
    double term = 1;
    for (size_t n = 1; term > sum * 1e-17; n++) {
        term *= x / (a + (double)n);
        sum += term;
    }
    return exp(a * log(x) - x - log_gamma) * sum;
}

double quantile_chi_squared(double part, size_t degrees)
{
    const double log_gamma = log_gamma_above_half(degrees);
    double low = 0;
    double high = (double)degrees + 20 * sqrt((double)degrees) + 40;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = (low + high) / 2;
        const bool is_below = below_chi_squared(middle, degrees, log_gamma) < part;
        low = is_below ? middle : low;
        high = is_below ? high : middle;
    }
    return (low + high) / 2;
}

/* P(|T| < tan(angle) √degrees), by 26.7.4: sin (1 + 1/2 cos² + (1 3)/(2 4) cos⁴ + ...), the last power degrees - 2. */
static double within_t(double angle, size_t degrees)
{
    const double squared = cos(angle) * cos(angle);
    double sum = 1;
    double term = 1;
    for (size_t k = 2; k < degrees && term > sum * 1e-17; k += 2) {
        term *= squared * (double)(k - 1) / (double)k;
        sum += term;
    }
    return sin(angle) * sum;
}

double quantile_t(double part, size_t degrees)
{
    double low = 0;
    double high = MATH3_PI / 2;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = (low + high) / 2;
        const bool is_below = within_t(middle, degrees) < 2 * part - 1;
        low = is_below ? middle : low;
        high = is_below ? high : middle;
    }
    return tan((low + high) / 2) * sqrt((double)degrees);
}
