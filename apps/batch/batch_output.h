/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The file that a batch becomes: what stands in its way, where an earlier run has got to, how to resume it. */
#ifndef CONUS_BATCH_BATCH_OUTPUT_H
#define CONUS_BATCH_BATCH_OUTPUT_H

#include "batch/batch_file.h"
#include "batch/batch_work.h"

/** Opens the prepared work's file as --force and --resume say; @p out then knows how many poses are answered. Where an
 * earlier run has written all of it, which only --resume takes for an answer, out->is_finished. Returns the exit code
 * and prints an error unless it is 0; @p out is the caller's to batch_file_close() in any case. */
int batch_output_open(struct batch_file *out, struct work *work);

/** Writes the sidecar and gives the file its name. Gives the exit code likewise. */
int batch_output_finish(struct batch_file *file, struct work *work);

/** Says that @p signal has ended the work behind @p poses poses, and which command resumes it. Gives the exit
 * code. */
int batch_output_interrupted(const struct work *work, uint64_t poses, int signal);

#endif
