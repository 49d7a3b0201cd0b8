/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The programs of conus, run as separate processes, and poses for them. */
#ifndef CONUS_BENCH_SUPPORT_PROGRAM_H
#define CONUS_BENCH_SUPPORT_PROGRAM_H

#include "bench/support/bench.h"

/** The folder of conus-bench itself, without a slash at its end; "." if the system does not say. */
void program_folder(char *out, size_t size);

/** Path of @p program: the value of the environment variable @p given, else beside conus-bench, else where the build
 * puts it. CONUS_ERROR_ARGUMENT if there is none. */
conus_status program_find(char *out, size_t size, const char *program, const char *given);

/** Runs @p arguments, the first of which is the path, without its output. CONUS_ERROR_ARGUMENT if it fails. */
conus_status program_run(char *const arguments[]);

/** Writes a table of @p count random poses round a grid to @p path: x y z tx ty tz, seen under @p angle_deg. */
conus_status program_write_poses(const char *path, size_t count, const conus_volume_info *info, double angle_deg);

#endif
