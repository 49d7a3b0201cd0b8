/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The temporal filters of Eq. 12, exact in time: their input is taken as linear between two samples, and the
 * differential equation is solved over the step, so that how often the device is read hardly matters. */
#ifndef CONUS_SELECTION_MEASURE_FILTER_H
#define CONUS_SELECTION_MEASURE_FILTER_H

/** The state of s' = @p rate (u - s) after @p dt seconds (0 or more), s being @p state at first and u going linearly
 * from @p from to @p to. */
double filter_linear(double state, double rate, double from, double to, double dt);

/** The same with the rate @p growth where u > s, and @p decay where u < s. */
double filter_asymmetric(double state, double growth, double decay, double from, double to, double dt);

#endif
