/* SPDX-License-Identifier: BSD-3-Clause */
/* Filters of first order, exact for linear input, for scores that need a history. */
#include "selection/measure/filter.h"

#include <math.h>
#include <stdbool.h>

double filter_linear(double state, double rate, double from, double to, double dt)
{
    double x = rate * dt;
    if (!(x > 0)) {
        return state;
    }
    double moved = -expm1(-x); /* 1 - e^-x */
    return state + (from - state) * moved + (to - from) * (1 - moved / x);
}

/* When u - s, which is `lead` at first and follows e' = slope - rate e, becomes 0; INFINITY if it never does. */
static double crossing(double lead, double rate, double slope)
{
    bool closing = lead > 0 ? slope < 0 : slope > 0;
    return lead != 0 && closing ? log1p(-rate * lead / slope) / rate : INFINITY;
}

double filter_asymmetric(double state, double growth, double decay, double from, double to, double dt)
{
    if (!(dt > 0)) {
        return state;
    }
    double slope = (to - from) / dt;
    double lead = from - state;
    bool grows = lead != 0 ? lead > 0 : slope > 0;
    double rate = grows ? growth : decay;
    double until = crossing(lead, rate, slope);
    if (until >= dt) {
        return filter_linear(state, rate, from, to, dt);
    }
    double met = from + slope * until; /* where both are equal; from there on s follows u at the other rate */
    return filter_linear(met, grows ? decay : growth, met, to, dt - until);
}
