/* SPDX-License-Identifier: BSD-3-Clause */
#include "mpi/ordered_file.h"

#include <string.h>
#include <time.h>
#include <zlib.h>

enum { CHUNK = 1 << 30 };

/* MPI counts in int. */
static int write_at(MPI_File file, uint64_t at, const char *text, size_t size)
{
    MPI_Status status;
    int error = MPI_SUCCESS;
    while (size && !error) {
        int count = size < CHUNK ? (int)size : CHUNK;
        error = MPI_File_write_at(file, (MPI_Offset)at, text, count, MPI_CHAR, &status);
        at += (uint64_t)count;
        text += count;
        size -= (size_t)count;
    }
    return error;
}

static uint32_t crc_of(const char *text, size_t size)
{
    return (uint32_t)crc32_z(0, (const unsigned char *)text, size);
}

/* On rank 0, whose memory it is. */
static void begin(struct ordered_file *file, const char *heading)
{
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
    memset(file->memory, 0, SHARED_COUNT * sizeof *file->memory);
    file->memory[BYTES] = strlen(heading);
    file->memory[CRC] = crc_of(heading, strlen(heading));
    MPI_Win_unlock(0, file->window);
}

int ordered_file_open(struct ordered_file *out, const char *path, const char *heading)
{
    int rank;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Aint size = rank == 0 ? SHARED_COUNT * sizeof *out->memory : 0;
    MPI_Win_allocate(size, sizeof *out->memory, MPI_INFO_NULL, MPI_COMM_WORLD, &out->memory, &out->window);
    if (rank == 0) {
        begin(out, heading);
    }
    int error = MPI_File_open(MPI_COMM_WORLD, path, MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL, &out->file);
    error = error ? error : MPI_File_set_size(out->file, 0);
    error = error || rank ? error : write_at(out->file, 0, heading, strlen(heading));
    MPI_Barrier(MPI_COMM_WORLD);
    return error;
}

uint64_t ordered_file_take(struct ordered_file *file)
{
    const uint64_t one = 1;
    uint64_t number = 0;
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, file->window);
    MPI_Fetch_and_op(&one, &number, MPI_UINT64_T, 0, NEXT_TO_TAKE, MPI_SUM, file->window);
    MPI_Win_unlock(0, file->window);
    return number;
}

/* Waits until it is the turn of piece `number`; then nobody else changes what is behind NEXT_TO_TAKE. */
static void wait_for_turn(struct ordered_file *file, uint64_t number, uint64_t shared[SHARED_COUNT])
{
    static const struct timespec moment = {.tv_nsec = 50000};
    for (;;) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
        MPI_Get(shared, SHARED_COUNT, MPI_UINT64_T, 0, 0, SHARED_COUNT, MPI_UINT64_T, file->window);
        MPI_Win_unlock(0, file->window);
        if (shared[NEXT_TO_WRITE] == number) {
            return;
        }
        nanosleep(&moment, NULL);
    }
}

int ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *piece)
{
    uint64_t shared[SHARED_COUNT];
    uint32_t crc = crc_of(piece->text, piece->size);
    wait_for_turn(file, number, shared);
    uint64_t begin = shared[BYTES];
    shared[CRC] = crc32_combine((uLong)shared[CRC], crc, (z_off_t)piece->size);
    shared[BYTES] += piece->size;
    shared[POSES] += piece->poses;
    shared[ERRORS] += piece->errors;
    shared[NEXT_TO_WRITE] = number + 1;
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
    MPI_Put(shared + NEXT_TO_WRITE, SHARED_COUNT - NEXT_TO_WRITE, MPI_UINT64_T, 0, NEXT_TO_WRITE,
            SHARED_COUNT - NEXT_TO_WRITE, MPI_UINT64_T, file->window);
    MPI_Win_unlock(0, file->window);
    return write_at(file->file, begin, piece->text, piece->size);
}

int ordered_file_close(struct ordered_file *file, uint64_t totals[SHARED_COUNT])
{
    int error = MPI_File_sync(file->file);
    int closed = MPI_File_close(&file->file);
    int rank;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
        memcpy(totals, file->memory, SHARED_COUNT * sizeof *totals);
        MPI_Win_unlock(0, file->window);
    }
    MPI_Win_free(&file->window);
    return error ? error : closed;
}
