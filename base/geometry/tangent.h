/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A tangent whose bits do not depend on the C library. */
#ifndef CONUS_BASE_TANGENT_H
#define CONUS_BASE_TANGENT_H

/** tan(@p x), rounded to nearest, for 0 <= x < pi / 2. C libraries differ in the last bit of theirs, and with it the
 * slope of a cone: the same question would have other rows in a browser. */
double tangent(double x);

#endif
