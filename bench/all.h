/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All scenarios, and the report of what they measured. */
#ifndef CONUS_BENCH_ALL_H
#define CONUS_BENCH_ALL_H

#include "bench/support/bench.h"

/* All scenarios, each in a separate process, so that none of them disturbs or ends the others. */

/** Runs @p scenarios and adds their measurements to @p bench and {name: settings} to @p settings. A scenario that
 * cannot run, crashes or takes too long is left out, with the reason. Progress goes to stderr. */
conus_status bench_all(struct bench *bench, json_t *settings, const struct bench_scenario *scenarios, size_t count);

/* The JSON of conus-bench: machine, settings, measurements, and whether each ratio keeps its bound. */

/** The JSON of everything measured. @p load is the load at the start; @p scenarios is {name: settings} of each that
 * ran, borrowed. NULL if memory runs out. */
json_t *report_create(const struct bench *bench, const json_t *scenarios, double load);

/** Settings of one scenario as they go into the JSON; NULL if memory runs out. */
json_t *report_settings(const struct bench *bench, double seconds, double load);

/** Load average of the last minute. */
double report_load(void);

conus_status report_write(const json_t *root, const char *path);

/** Prints which ratios keep their bounds. */
void report_print_holds(const json_t *root);

/** Prints failures of --check to stderr: answers that differ without being meant to, ratios that are null, a crash.
 * Returns their number. */
size_t report_check(const json_t *root);

#endif
