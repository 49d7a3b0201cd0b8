/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Pieces of work for all ranks, and one file to which their results go in the pieces' order. What all share lies on
 * rank 0, in a window of memory that each locks for itself: the number of the next piece to hand out, where the piece
 * that is next in the file begins, and what has been written but is not in the journal yet, which rank 0 keeps. No rank
 * holds more than one finished piece. */
#ifndef CONUS_MPI_ORDERED_FILE_H
#define CONUS_MPI_ORDERED_FILE_H

#include "cli/batch_file.h"

#include <mpi.h>

struct ordered_file {
    MPI_Win window;
    uint64_t *memory; /**< The window's, on rank 0. */
    MPI_File file;
    const char *path;        /**< What the file becomes, for messages. */
    struct batch_file *kept; /**< On rank 0: the journal and what it counts; else NULL. */
    int ranks;
    double looked; /**< When ordered_file_look() was called last, seconds. */
    int stop;      /**< What it found. */
    bool is_over;  /**< No rank has a piece any more, and all are in the journal. */
};

/** Goes on behind the @p size bytes that are in the file @p part; all ranks at once. @p kept is rank 0's, opened. Gives
 * the exit code, having complained unless it is 0; then there is nothing to close. */
int ordered_file_open(struct ordered_file *out, const char *path, uint64_t size, struct batch_file *kept);

/** The number of a piece that nobody has had, from 0. */
uint64_t ordered_file_take(struct ordered_file *file);

/** Fills in the journal, on rank 0, and lets all stop if there was a signal. Gives why all are to stop, 0 to go on: an
 * exit code, 128 and more of a signal. */
int ordered_file_look(struct ordered_file *file);

/** The same at most every few milliseconds: to be called all the time. */
int ordered_file_tend(struct ordered_file *file);

/** Lets all stop for that reason, if they do not for a higher number already. */
void ordered_file_stop(struct ordered_file *file, int code);

/** Writes piece @p number once all before it have their place: every number that was taken must be written, unless all
 * stop, which is when it gives up. */
void ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *piece);

/** Tells that this rank has no piece and takes no more. */
void ordered_file_end(struct ordered_file *file);

/** Closes it; all ranks at once. False where a rank could not. */
bool ordered_file_close(struct ordered_file *file);

#endif
