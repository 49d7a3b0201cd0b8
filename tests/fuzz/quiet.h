/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A fuzzer's log is no place for a million complaints of the program. */
#ifndef CONUS_TESTS_FUZZ_QUIET_H
#define CONUS_TESTS_FUZZ_QUIET_H

#include <stdio.h>

/** Lets stderr lead nowhere; gives what it was, to be put back. */
static inline FILE *be_quiet(void)
{
    static FILE *nowhere;
    FILE *kept = stderr;
    nowhere = nowhere ? nowhere : fopen("/dev/null", "we");
    stderr = nowhere ? nowhere : stderr;
    return kept;
}

#endif
