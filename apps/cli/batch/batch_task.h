/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One run of a batch, from its options to its file. */
#ifndef CONUS_CLI_BATCH_TASK_H
#define CONUS_CLI_BATCH_TASK_H

#include "cli/batch/batch_settings.h"

/** Answers the poses, those of settings->part, and writes settings->output. Returns the exit code and prints an error
 * unless it is 0; 128 and more is that of a signal. */
int batch_answer(const struct batch_settings *settings, const struct arguments *arguments);

#endif
