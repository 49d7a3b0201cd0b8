/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A table of batches: columns atlas, poses, output, each row one. */
#ifndef CONUS_BATCH_BATCH_JOBS_H
#define CONUS_BATCH_BATCH_JOBS_H

#include <stddef.h>

struct batch_job {
    const char *atlas, *poses, *output;
    size_t line; /**< Line of the table, from 1. */
};

struct batch_jobs {
    char *text; /**< The jobs point into it. */
    struct batch_job *jobs;
    size_t count;
};

/** Parses a table of @p size bytes at @p text, with a NUL behind them. It takes @p text over in any case; @p path is
 * for messages. Returns the exit code and prints an error unless it is 0; then there is nothing to finish. */
int batch_jobs_parse(struct batch_jobs *out, const char *path, char *text, size_t size);
void batch_jobs_finish(struct batch_jobs *jobs);

#endif
