/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Parts of work (16 blocks each) for all ranks, and one file with their results in the parts' order. The coordinator on
 * rank 0 hands out the parts' numbers and the places of their rows in the file, and keeps the journal. The others ask
 * it by messages, which it answers between its own blocks: that needs nothing of MPI but messages, and no rank that
 * dies holds a lock. No rank holds more than one finished part. */
#ifndef CONUS_MPI_ORDERED_FILE_H
#define CONUS_MPI_ORDERED_FILE_H

#include "batch/batch_file.h"

#include <mpi.h>

struct coordinator; /* of rank 0 */

struct ordered_file {
    MPI_File file;
    const char *path;                /**< The final name, for messages. */
    struct coordinator *coordinator; /**< NULL on other ranks than 0. */
    int stop;                        /**< Why all are to stop, 0 to continue: an exit code, 128 and more of a signal. */
    bool has_next;                   /**< `next` is the number of a part that is this rank's to answer. */
    uint64_t next;
};

/** Resumes behind the @p size bytes that are in the partial file of @p path; all ranks at once. @p kept is rank 0's,
 * opened; NULL on others. Returns the exit code and prints an error unless it is 0; then there is nothing to close. */
int ordered_file_open(struct ordered_file *out, const char *path, uint64_t size, struct batch_file *kept);

/** Takes the next part number, from 0. Returns false when the run stops. */
bool ordered_file_take(struct ordered_file *file, uint64_t *number);

/** Call between blocks: handles signals, messages and the journal. Returns false when the run stops. */
bool ordered_file_tend(struct ordered_file *file);

/** Lets all stop for the reason @p code. */
void ordered_file_stop(struct ordered_file *file, int code);

/** Writes part @p number once all before it have their place; not if all are to stop, when it may not be whole. With
 * @p is_last this rank takes no more. */
void ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *part, bool is_last);

/** To be called on rank 0 once it has no part left. Waits until the other ranks have none and the journal has all, or
 * until all are to stop. */
void ordered_file_wait(struct ordered_file *file);

/** Closes the file; all ranks call it together. Gives the reason why all were to stop, or the exit code of what failed.
 */
int ordered_file_close(struct ordered_file *file);

#endif
