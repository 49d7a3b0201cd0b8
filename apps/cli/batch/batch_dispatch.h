/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The way of every batch: from the command line to one run for each file of rows. */
#ifndef CONUS_CLI_BATCH_DISPATCH_H
#define CONUS_CLI_BATCH_DISPATCH_H

#include "cli/batch/batch_settings.h"

/** Writes each file that the command line asks for, as long as all is well. Gives the most serious exit code, and
 * prints an error about files that exclude each other. */
int batch_dispatch(const struct batch_settings *settings, const struct arguments *arguments);

#endif
