/* SPDX-License-Identifier: BSD-3-Clause */
#include "mpi/ordered_file.h"

#include "cli/interrupt.h"
#include "cli/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHUNK = 1 << 30, RING = 1024 };

/* All numbers, so that they travel as one array; behind them the ring of entries. Piece n has slot n % RING, which is
 * free once that of piece n - RING is in the journal. */
enum shared { STOP, ENDED, NEXT_TO_TAKE, NEXT_TO_WRITE, BYTES, NOTED, SHARED_COUNT };
enum slot { FILLED, POSES, ERRORS, SIZE, CRC, SLOT_COUNT }; /* FILLED is the number of the piece and 1 */

static const double seconds_between_looks = 0.01;

static bool check(const struct ordered_file *file, int error, const char *action)
{
    char text[MPI_MAX_ERROR_STRING];
    int length;
    if (error) {
        MPI_Error_string(error, text, &length);
        complain("%s: cannot %s: %s", file->path, action, text);
    }
    return !error;
}

/* MPI counts in int. */
static int write_at(MPI_File file, uint64_t at, const char *text, size_t size)
{
    MPI_Status status;
    int error = MPI_SUCCESS;
    while (size && !error) {
        int count = size < CHUNK ? (int)size : CHUNK;
        int written = 0;
        error = MPI_File_write_at(file, (MPI_Offset)at, text, count, MPI_CHAR, &status);
        if (!error) {
            MPI_Get_count(&status, MPI_CHAR, &written);
            error = written == count ? MPI_SUCCESS : MPI_ERR_NO_SPACE;
        }
        at += (uint64_t)count;
        text += count;
        size -= (size_t)count;
    }
    return error;
}

int ordered_file_open(struct ordered_file *out, const char *path, uint64_t size, struct batch_file *kept)
{
    struct ordered_file file = {.path = path, .kept = kept};
    char *part = NULL;
    size_t numbers = kept ? SHARED_COUNT + RING * SLOT_COUNT : 0;
    MPI_Comm_size(MPI_COMM_WORLD, &file.ranks);
    MPI_Win_allocate((MPI_Aint)(numbers * sizeof *file.memory), sizeof *file.memory, MPI_INFO_NULL, MPI_COMM_WORLD,
                     &file.memory, &file.window);
    if (kept) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file.window);
        memset(file.memory, 0, numbers * sizeof *file.memory);
        file.memory[BYTES] = size;
        MPI_Win_unlock(0, file.window);
    }
    int error = asprintf(&part, "%s.part", path) < 0 ? MPI_ERR_NO_MEM : MPI_SUCCESS;
    int code = error;
    MPI_Allreduce(&error, &code, 1, MPI_INT, MPI_MAX,
                  MPI_COMM_WORLD); /* after which no rank begins too early, either */
    if (!code) {
        error = MPI_File_open(MPI_COMM_WORLD, part, MPI_MODE_WRONLY, MPI_INFO_NULL, &file.file);
        MPI_Allreduce(&error, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    }
    free(part);
    if (code) {
        check(&file, error, "write");
        MPI_Win_free(&file.window);
        return EXIT_DATA;
    }
    *out = file;
    return EXIT_DONE;
}

static uint64_t fetch(struct ordered_file *file, enum shared what, MPI_Op operation, uint64_t operand)
{
    uint64_t before = 0;
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, file->window);
    MPI_Fetch_and_op(&operand, &before, MPI_UINT64_T, 0, what, operation, file->window);
    MPI_Win_unlock(0, file->window);
    return before;
}

uint64_t ordered_file_take(struct ordered_file *file)
{
    return fetch(file, NEXT_TO_TAKE, MPI_SUM, 1);
}

void ordered_file_stop(struct ordered_file *file, int code)
{
    fetch(file, STOP, MPI_MAX, (uint64_t)code);
}

/* On rank 0: takes the entry that is next in the journal off the ring; false while that is not there. */
static bool take_entry(struct ordered_file *file, struct batch_entry *out)
{
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
    uint64_t number = file->memory[NOTED];
    const uint64_t *slot = file->memory + SHARED_COUNT + number % RING * SLOT_COUNT;
    bool is_there = slot[FILLED] == number + 1;
    if (is_there) {
        *out = (struct batch_entry){slot[POSES], slot[ERRORS], slot[SIZE], (uint32_t)slot[CRC]};
        file->memory[NOTED]++;
    }
    MPI_Win_unlock(0, file->window);
    return is_there;
}

static void fill_journal(struct ordered_file *file)
{
    struct batch_entry entry;
    while (file->kept && take_entry(file, &entry)) {
        int code = entry.poses ? batch_file_note(file->kept, &entry) : EXIT_DONE;
        if (code) {
            ordered_file_stop(file, code);
            return;
        }
    }
}

/* Sees to signals and the journal, and reads what all share. */
static void look(struct ordered_file *file, uint64_t shared[SHARED_COUNT])
{
    if (interrupt_signal()) {
        ordered_file_stop(file, 128 + interrupt_signal());
    }
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
    MPI_Get(shared, SHARED_COUNT, MPI_UINT64_T, 0, 0, SHARED_COUNT, MPI_UINT64_T, file->window);
    MPI_Win_unlock(0, file->window);
    fill_journal(file); /* behind the look: who has ended has written */
    file->stop = (int)shared[STOP];
    file->is_over = shared[ENDED] == (uint64_t)file->ranks;
    file->looked = MPI_Wtime();
}

int ordered_file_look(struct ordered_file *file)
{
    uint64_t shared[SHARED_COUNT];
    look(file, shared);
    return file->stop;
}

int ordered_file_tend(struct ordered_file *file)
{
    return MPI_Wtime() - file->looked < seconds_between_looks ? file->stop : ordered_file_look(file);
}

static void rest(void)
{
    static const struct timespec moment = {.tv_nsec = 200000};
    nanosleep(&moment, NULL);
}

/* Waits until it is the turn of piece `number` and its slot is free; then nobody else changes NEXT_TO_WRITE and BYTES.
 * False when all are to stop. */
static bool wait_for_turn(struct ordered_file *file, uint64_t number, uint64_t shared[SHARED_COUNT])
{
    for (;;) {
        look(file, shared);
        if (file->stop) {
            return false;
        }
        if (shared[NEXT_TO_WRITE] == number && number - shared[NOTED] < RING) {
            return true;
        }
        rest();
    }
}

static void put(struct ordered_file *file, const uint64_t *numbers, int count, size_t at)
{
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, file->window);
    MPI_Put(numbers, count, MPI_UINT64_T, 0, (MPI_Aint)at, count, MPI_UINT64_T, file->window);
    MPI_Win_unlock(0, file->window);
}

void ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *piece)
{
    uint64_t shared[SHARED_COUNT];
    const struct batch_entry entry = batch_entry_of(piece);
    if (!wait_for_turn(file, number, shared)) {
        return;
    }
    const uint64_t next[] = {number + 1, shared[BYTES] + piece->size};
    put(file, next, 2, NEXT_TO_WRITE);
    if (!check(file, write_at(file->file, shared[BYTES], piece->text, piece->size), "write")) {
        ordered_file_stop(file, EXIT_DATA);
        return;
    }
    const uint64_t slot[SLOT_COUNT] = {number + 1, entry.poses, entry.errors, entry.size, entry.crc};
    put(file, slot, SLOT_COUNT, SHARED_COUNT + number % RING * SLOT_COUNT);
}

void ordered_file_end(struct ordered_file *file)
{
    fetch(file, ENDED, MPI_SUM, 1);
}

bool ordered_file_close(struct ordered_file *file)
{
    int error = MPI_File_sync(file->file);
    int closed = MPI_File_close(&file->file);
    bool whole = check(file, error ? error : closed, "write");
    MPI_Win_free(&file->window);
    return whole;
}
