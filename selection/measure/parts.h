/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the sources of measure/ share: Gauss's rule, and integrals of weights over whole regions. */
#ifndef CONUS_SELECTION_MEASURE_PARTS_H
#define CONUS_SELECTION_MEASURE_PARTS_H

#include "selection/region/region.h"
#include "selection/weight/weight.h"

enum { GAUSS_POINTS = 4 };

/** Gauss's four points between 0 and 1, and their weights, which sum to 1: exact for polynomials up to degree 7. */
static const struct {
    double at, weight;
} gauss_rule[GAUSS_POINTS] = {{0.06943184420297371, 0.17392742256872693},
                              {0.33000947820757187, 0.32607257743127307},
                              {0.66999052179242813, 0.32607257743127307},
                              {0.93056815579702629, 0.17392742256872693}};

/** The integral of W over the region, mm^3 times its unit; infinite where the region has no end. With a @p level that
 * is a number the volume in which W is that or more. */
double dose_whole(const conus_weight *weight, const struct region *region, double level);

/** The largest W in the region. */
double dose_largest(const conus_weight *weight, const struct region *region);

#endif
