/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether two answers have the same numbers. */
#ifndef CONUS_TESTS_SUPPORT_SAME_ANSWER_H
#define CONUS_TESTS_SUPPORT_SAME_ANSWER_H

#include "conus/selection.h"

/** Fails unless the numbers are equal, or NaN in both; -0 equals 0. */
void assert_same_doubles(const double *a, const double *b, size_t count);

/** Fails unless the results are equal, but for @p tolerance in sums over voxels, whose order may differ. A sum of x may
 * be off by tolerance (1 + |x|). */
void assert_same_result(const conus_result *a, const conus_result *b, double tolerance);

/** The same of all results, and of pixels and intervals. */
void assert_same_answer(const conus_selection *a, const conus_selection *b, double tolerance);

#endif
