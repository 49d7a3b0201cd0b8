/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One batch, or a table of them: columns atlas, poses, output, each row one. */
#ifndef CONUS_BATCH_BATCH_JOBS_H
#define CONUS_BATCH_BATCH_JOBS_H

#include "batch/batch_settings.h"

/** Answers one batch. Returns the exit code and prints an error unless it is 0; 128 and more is that of a signal. */
typedef int batch_answer(void *user, const struct batch_settings *settings, const struct arguments *arguments);

/** Calls @p answer for the batch that is asked for, or for each of those of --jobs that are the shard's; on with the
 * next one where one cannot be answered, unless a signal was the reason. Gives the exit code that says most, after an
 * error message about what is missing. */
int batch_jobs_answer(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user);

#endif
