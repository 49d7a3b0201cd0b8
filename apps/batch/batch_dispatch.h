/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The way of every batch: from the command line to one call for each file of rows. */
#ifndef CONUS_BATCH_BATCH_DISPATCH_H
#define CONUS_BATCH_BATCH_DISPATCH_H

#include "batch/batch_settings.h"

/** Answers one batch. Returns the exit code and prints an error unless it is 0; 128 and more is that of a signal. */
typedef int batch_answer(void *user, const struct batch_settings *settings, const struct arguments *arguments);

/** Calls @p answer for each file that the command line asks for, as long as all is well. Gives the most serious exit
 * code, and prints an error about files that exclude each other. */
int batch_dispatch(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                   void *user);

#endif
