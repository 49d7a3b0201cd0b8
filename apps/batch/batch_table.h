/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A table of batches: columns atlas, poses, output, each row one. */
#ifndef CONUS_BATCH_BATCH_TABLE_H
#define CONUS_BATCH_BATCH_TABLE_H

#include <stddef.h>

struct batch_job {
    const char *atlas, *poses, *output;
    size_t line; /**< Of the table, from 1. */
};

struct batch_jobs {
    char *text; /**< What the jobs point into. */
    struct batch_job *jobs;
    size_t count;
};

/** Reads it. Returns the exit code and prints an error unless it is 0; then there is nothing to finish. */
int batch_jobs_read(struct batch_jobs *out, const char *path);
/** The same from @p size bytes at @p text and a NUL behind them, which are taken over in any case; @p path is for
 * messages. */
int batch_jobs_parse(struct batch_jobs *out, const char *path, char *text, size_t size);
void batch_jobs_finish(struct batch_jobs *jobs);

#endif
