/* SPDX-License-Identifier: BSD-3-Clause */
/** @file All scenarios, each in a separate process, so that none of them disturbs or ends the others. */
#ifndef CONUS_BENCH_ALL_H
#define CONUS_BENCH_ALL_H

#include "bench/support/bench.h"

/** Runs @p scenarios and adds their measurements to @p bench and {name: settings} to @p settings. A scenario that
 * cannot run, crashes or takes too long is left out, with the reason. Progress goes to stderr. */
conus_status bench_all(struct bench *bench, json_t *settings, const struct bench_scenario *scenarios, size_t count);

#endif
