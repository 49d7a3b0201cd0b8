/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The one clock of the programs. */
#ifndef CONUS_OPTIONS_CLOCK_H
#define CONUS_OPTIONS_CLOCK_H

#include <time.h>

/** Monotonic time in ms, from an arbitrary origin. */
static inline double clock_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

#endif
