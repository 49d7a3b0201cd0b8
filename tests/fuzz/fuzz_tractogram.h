/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reads all numbers of an accepted tractogram. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_TRACTOGRAM_H
#define CONUS_TESTS_FUZZ_FUZZ_TRACTOGRAM_H

#include "atlas/tracts/tractogram.h"

#include <math.h>
#include <stdlib.h>

/** Reads every number of a tractogram that passed tractogram_check(), so that a sanitizer notices a missing one. */
static inline void fuzz_tractogram_read(const struct tractogram *t)
{
    double sum = 0;
    for (uint64_t i = 0; i < t->point_count; i++) {
        double point[3];
        tractogram_point(point, t, i);
        sum += fabs(point[0]) + fabs(point[1]) + fabs(point[2]);
    }
    for (size_t s = 0; s < t->scalar_count; s++) {
        uint64_t rows = t->scalars[s].per_point ? t->point_count : t->streamline_count;
        for (uint64_t i = 0; i < rows * t->scalars[s].components; i++) {
            sum += isnan(t->scalars[s].values[i]) ? 1 : 0;
        }
    }
    for (size_t g = 0; g < t->group_count; g++) {
        for (size_t i = 0; i < t->groups[g].count; i++) {
            sum += tractogram_length(t, t->groups[g].members[i]);
        }
    }
    if (!isfinite(sum)) {
        abort();
    }
}

#endif
