/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Silences stderr: a fuzzer's log has no room for a million messages of the program. */
#ifndef CONUS_TESTS_FUZZ_QUIET_H
#define CONUS_TESTS_FUZZ_QUIET_H

#include <stdio.h>

/** Redirects stderr to nowhere; returns the old stream, to be put back. */
static inline FILE *be_quiet(void)
{
    static FILE *nowhere;
    FILE *kept = stderr;
    nowhere = nowhere ? nowhere : fopen("/dev/null", "we");
    stderr = nowhere ? nowhere : stderr;
    return kept;
}

#endif
