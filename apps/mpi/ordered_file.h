/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Pieces of work for all ranks, and one file to which their results go in the pieces' order. What all share lies on
 * rank 0, in a window of memory that each locks for itself: the number of the next piece to hand out, and where the
 * piece that is next in the file begins. No rank holds more than one finished piece. */
#ifndef CONUS_MPI_ORDERED_FILE_H
#define CONUS_MPI_ORDERED_FILE_H

#include <conus/conus.h>

#include <mpi.h>

/** All numbers, so that they travel as one array. */
enum shared { NEXT_TO_TAKE, NEXT_TO_WRITE, BYTES, POSES, ERRORS, CRC, SHARED_COUNT };

struct ordered_file {
    MPI_Win window;
    uint64_t *memory; /**< [SHARED_COUNT] on rank 0. */
    MPI_File file;
};

/** Opens @p path anew and writes @p heading; all ranks at once. An MPI error code. */
int ordered_file_open(struct ordered_file *out, const char *path, const char *heading);

/** The number of a piece that nobody has had, from 0. */
uint64_t ordered_file_take(struct ordered_file *file);

/** Writes piece @p number once all before it have their place: every number that was taken must be written. An MPI
 * error code. */
int ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *piece);

/** Closes it; all ranks at once. @p totals: what has been written, on rank 0. */
int ordered_file_close(struct ordered_file *file, uint64_t totals[SHARED_COUNT]);

#endif
