/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Sine, cosine and arc tangent whose bits do not depend on the C library, as tangent() in tangent.h: sums of many arcs
 * around a surface show the last bit of theirs in the ninth digit of a volume. */
#ifndef CONUS_BASE_ARC_H
#define CONUS_BASE_ARC_H

/** sin(@p x) and cos(@p x), within 2e-16, for |x| <= 1000 radians. NaN of what is not finite. */
void sine_cosine(double *sine, double *cosine, double x);

static inline double sine_of(double x)
{
    double sine;
    double cosine;
    sine_cosine(&sine, &cosine, x);
    return sine;
}

static inline double cosine_of(double x)
{
    double sine;
    double cosine;
    sine_cosine(&sine, &cosine, x);
    return cosine;
}

/** The angle from the x axis to (@p x, @p y), -pi to pi, within 2 units in the last place. @p y where both are 0. NaN
 * where one is not finite. */
double arc_tangent(double y, double x);

#endif
