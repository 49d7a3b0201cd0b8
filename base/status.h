/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * How internal functions report failure: a status, and one line kept per thread.
 * The line is written where the fact is known and only ever prefixed further up. */
#ifndef CONUS_BASE_STATUS_H
#define CONUS_BASE_STATUS_H

#include "conus/status.h"

#include <stdint.h>

/** Sets this thread's message from @p format (one line, no final period) and returns @p status. */
conus_status fail(conus_status status, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Puts "@p where: " in front of this thread's message and returns @p status, so that a reader of bytes
 * need not know its path: `return fail_in(status, path);` */
conus_status fail_in(conus_status status, const char *where);

#ifdef __clang_analyzer__ /* which does not see that they return their argument */
#define fail(status, ...) ((void)fail(status, __VA_ARGS__), (status))
#define fail_in(status, where) ((void)fail_in(status, where), (status))
#endif

#endif
