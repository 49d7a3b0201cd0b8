/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Curves: what something costs at several sizes, and the exponent with which it grows. */
#ifndef CONUS_BENCH_GROWTH_GROWTH_H
#define CONUS_BENCH_GROWTH_GROWTH_H

#include "bench/bench.h"

enum { GROWTH_POINTS = 12, GROWTH_NAME = 64 };

struct growth_curve {
    struct bench *bench; /**< Borrowed.                                                */
    const char *name;    /**< A literal; part of the keys in the JSON.                 */
    double angle_deg;    /**< Of the cones; 0 where they differ, or there are none.    */
    size_t count;
    double x[GROWTH_POINTS], ms[GROWTH_POINTS];
    bool equal; /**< All points' answers are as they should be. */
};

/** An empty curve. */
struct growth_curve growth_begin(struct bench *bench, const char *name, double angle_deg);

/** Makes @p variant, which is to be measured, the curve's point at @p x; writes its name to @p name. */
void growth_name(char name[GROWTH_NAME], const struct growth_curve *curve, double x, struct bench_variant *variant);

/** Appends the point at @p x that was measured. */
void growth_take(struct growth_curve *curve, double x, const struct bench_variant *variant);

/** Names, measures in turn and appends @p count points at the sizes @p x, with @p per queries in a run. */
conus_status growth_add(struct growth_curve *curve, const double *x, struct bench_variant *variants, size_t count,
                        size_t per);

/** Adds the exponent of all points as `growth_NAME`, and to each run but the first its slope from the one before. */
conus_status growth_end(struct growth_curve *curve);

/** How many of @p count sizes to measure: in a check only the first ones. */
size_t growth_sizes(const struct bench *bench, size_t count);

/* The curves. */
conus_status growth_voxels(struct bench *bench);
conus_status growth_objects(struct bench *bench);
conus_status growth_torus_angle(struct bench *bench);

#endif
