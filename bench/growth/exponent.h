/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The exponent of a power law. */
#ifndef CONUS_BENCH_GROWTH_EXPONENT_H
#define CONUS_BENCH_GROWTH_EXPONENT_H

#include <stddef.h>

/** b of y = a x^b through @p count points by least squares in the logarithms; all x and y are above 0. NAN unless there
 * are two different x. */
double growth_exponent(const double *x, const double *y, size_t count);

#endif
