/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One batch, or a table of them: columns atlas, poses, output, each row one. */
#ifndef CONUS_BATCH_BATCH_JOBS_H
#define CONUS_BATCH_BATCH_JOBS_H

#include "batch/batch_settings.h"

struct batch_job {
    const char *atlas, *poses, *output;
    size_t line; /**< Line of the table, from 1. */
};

struct batch_jobs {
    char *text; /**< The jobs point into it. */
    struct batch_job *jobs;
    size_t count;
};

/** Parses a table, @p size bytes at @p text and a NUL behind them, which are taken over in any case; @p path is for
 * messages. Returns the exit code and prints an error unless it is 0; then there is nothing to finish. */
int batch_jobs_parse(struct batch_jobs *out, const char *path, char *text, size_t size);
void batch_jobs_finish(struct batch_jobs *jobs);

/** Answers one batch. Returns the exit code and prints an error unless it is 0; 128 and more is that of a signal. */
typedef int batch_answer(void *user, const struct batch_settings *settings, const struct arguments *arguments);

/** Calls @p answer for the batch that is asked for, or for each of those of --jobs that are the shard's; where one
 * cannot be answered it continues with the next, unless a signal was the reason. Gives the most serious exit code, and
 * prints an error about operands and options that are missing or exclude each other. */
int batch_jobs_answer(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user);

#endif
