/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The monotonic clock, for deadlines and measured times. */
#ifndef CONUS_BASE_CLOCK_H
#define CONUS_BASE_CLOCK_H

#include <time.h>

/** Seconds since a fixed moment in the past; setting the date does not change them. Inline, so that programs outside
 * the library can use it. */
static inline double clock_seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

#endif
