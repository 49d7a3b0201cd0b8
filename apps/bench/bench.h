/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * conus-bench: scenarios in a table, and what they share: interleaved timing, statistics, JSON. A scenario may use the
 * library's internals. Every ratio stands on variants that ran side by side in one process and gave equal answers. */
#ifndef CONUS_APPS_BENCH_H
#define CONUS_APPS_BENCH_H

#include "atlas/atlas.h"

#include <jansson.h>

struct bench_options {
    const char *atlas;   /**< Path.                                       */
    const char *context; /**< Path of the context volume, for pictures.   */
    double angle;        /**< Full opening, degrees.                      */
    size_t poses;
    size_t slices;      /**< Planes of the colour pass.               */
    size_t repeats;     /**< Rounds in which every variant runs once. */
    const char *record; /**< Where the poses of a hand go; NULL = nowhere. */
};

/** Everything measured, as it goes into the JSON. */
struct bench {
    struct bench_options options;
    json_t *runs;
    json_t *ratios;
    char driver[128]; /**< Engine or GL renderer in use.                                              */
    bool one_thread;  /**< Set by a scenario whose variants all run on the calling thread: then its CPU
                           time is taken, which other programs on the machine hardly disturb.        */
};

/** Something to time. */
struct bench_variant {
    const char *name;
    void (*run)(void *data);
    void *data;
    bool equal;                       /**< Its answers equal the first variant's.       */
    double median_ms, min_ms, p90_ms; /**< Out: one run / `per`.  */
};

/** Times the variants in turn, options.repeats times, and adds them to the runs. What is timed is the second of two
 * runs on end, as in a batch that goes on. Times are those of one run divided by @p per (queries in a run, say);
 * @p angle_deg 0 where there is no cone. */
conus_status bench_measure(struct bench *bench, const char *scenario, struct bench_variant *variants, size_t count,
                           size_t per, double angle_deg);

/** Adds ratio @p key = @p above / @p below, by medians; null with the reason where their answers differ. */
conus_status bench_ratio(struct bench *bench, const char *key, const struct bench_variant *above,
                         const struct bench_variant *below);

/** Milliseconds: of this thread's CPU time or of the wall clock. */
double bench_now(const struct bench *bench);

/** A deterministic generator (SplitMix64); uniform in [low, high). */
double bench_random(uint64_t *state, double low, double high);

struct bench_scenario {
    const char *name, *description;
    conus_status (*run)(struct bench *bench);
};

conus_status bench_census(struct bench *bench);
conus_status bench_batch(struct bench *bench);
conus_status bench_colour(struct bench *bench);
conus_status bench_hand(struct bench *bench);
conus_status bench_volume(struct bench *bench);
conus_status bench_mesh(struct bench *bench);
conus_status bench_torus(struct bench *bench);
conus_status bench_torus_gl(struct bench *bench); /**< Its part that needs OpenGL. */
conus_status bench_gl_layers(struct bench *bench);
conus_status bench_layers(struct bench *bench);

#endif
