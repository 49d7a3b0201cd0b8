/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What single precision may change (docs/model.md, Eq. 6).
 *
 * Files keep scales, values and directions as float32, and programs compute with them: 255 times float32(1/255) is
 * 1.00000006. A comparison of a file's number with an exact one allows for this, and for no more. */
#ifndef CONUS_BASE_TOLERANCE_H
#define CONUS_BASE_TOLERANCE_H

#include <math.h>
#include <stdbool.h>

/** Relative: four steps of a float32, a scale, an offset, a product and a sum. */
#define TOLERANCE 0x1p-21

/** From here on a float32 no longer holds every whole number. (A double does up to 2^53, which no label reaches.) */
#define TOLERANCE_SINGLE_END 0x1p24

/** The least value that reaches @p bound. */
static inline double tolerance_least(double bound)
{
    return isfinite(bound) ? bound - TOLERANCE * fabs(bound) : bound;
}

/** Whether both may be the same number. */
static inline bool tolerance_same(double a, double b)
{
    return a == b || fabs(a - b) <= TOLERANCE * fmin(fabs(a), fabs(b)); /* no number is infinity */
}

/** @p value rounded, if it may be a whole number that comes from terms up to @p size, else as it is. Beyond 1/16 nobody
 * knows which one it was. */
static inline double tolerance_whole(double value, double size)
{
    double off = fabs(value - rint(value));
    return off <= 0x1p-4 && off <= TOLERANCE * (size > 1 ? size : 1) ? rint(value) : value;
}

#endif
