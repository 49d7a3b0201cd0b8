/* SPDX-License-Identifier: BSD-3-Clause */
/* Taylor's series near 0, to where the next term is below half a bit. */
#include "base/geometry/math3.h"

#include <math.h>
#include <stdbool.h>

/* Half of pi as two numbers. Multiples of the first, of 33 bits, are exact. */
static const double half_pi[2] = {0x1.921fb544p+0, 0x1.0b4611a626331p-34};

void sine_cosine(double *sine, double *cosine, double x)
{
    static const double of_sine[] = {1 / 355687428096000.0, -1 / 1307674368000.0, 1 / 6227020800.0, -1 / 39916800.0,
                                     1 / 362880.0,          -1 / 5040.0,          1 / 120.0,        -1 / 6.0};
    static const double of_cosine[] = {1 / 20922789888000.0, -1 / 87178291200.0, 1 / 479001600.0, -1 / 3628800.0,
                                       1 / 40320.0,          -1 / 720.0,         1 / 24.0,        -1 / 2.0};
    double quarters = floor(x * (2 / M_PI) + 0.5);
    double rest = x - quarters * half_pi[0] - quarters * half_pi[1]; /* at most pi / 4 */
    double square = rest * rest;
    double s = 0;
    double c = 0;
    for (int i = 0; i < 8; i++) {
        s = of_sine[i] + square * s;
        c = of_cosine[i] + square * c;
    }
    s = rest + rest * square * s;
    c = 1 + square * c;
    double quadrant = quarters - 4 * floor(quarters / 4);
    bool swapped = quadrant == 1 || quadrant == 3;
    *sine = (swapped ? c : s) * (quadrant >= 2 ? -1 : 1);
    *cosine = (swapped ? s : c) * (quadrant == 1 || quadrant == 2 ? -1 : 1);
}

double arc_tangent(double y, double x)
{
    /* of 0, 1/8, ... 1 */
    static const double eighths[] = {0,
                                     0.12435499454676144,
                                     0.24497866312686414,
                                     0.35877067027057225,
                                     0.4636476090008061,
                                     0.5585993153435624,
                                     0.6435011087932844,
                                     0.7188299996216245,
                                     M_PI / 4};
    double up = fabs(y);
    double right = fabs(x);
    double large = up > right ? up : right;
    double small = up > right ? right : up;
    double ratio = small / large;
    if (!(ratio <= 1)) {
        return large == 0 ? y : ratio;
    }
    int nearest = (int)(ratio * 8 + 0.5);
    double begin = nearest / 8.0;
    double rest = (small - begin * large) / (large + begin * small); /* the tangent of what is left: at most 1/16 */
    double square = rest * rest;
    double series = 0;
    for (int n = 13; n > 1; n -= 2) {
        series = (n % 4 == 1 ? 1.0 : -1.0) / n + square * series;
    }
    double angle = eighths[nearest] + (rest + rest * square * series);
    angle = up > right ? M_PI / 2 - angle : angle;
    return copysign(x < 0 ? M_PI - angle : angle, y);
}
