/* SPDX-License-Identifier: BSD-3-Clause */
/* The file of all ranks: the coordinator on rank 0, and the messages between it and the other ranks. */
#include "mpi/ordered_file.h"

#include "options/interrupt.h"
#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHUNK = 1 << 30, LEAST_SLOTS = 1024 };
enum tag { TO_COORDINATOR = 1, FROM_COORDINATOR };

/* Requests to rank 0 with their numbers; its replies. */
enum request { TAKE, ANSWERED, ANSWERED_LAST, WRITTEN, STOP, END };
enum { KIND, NUMBER, POSES, ERRORS, SIZE, CRC, REQUEST_SIZE };
enum reply { GRANTED, PLACED, STOPPED, FAREWELL };
enum { PLACE = 1, NEXT, HAS_NEXT, REPLY_SIZE };

/* A part on its way into the journal: answered by `rank`, then with its place, then written. */
struct slot {
    enum { SLOT_FREE, SLOT_ANSWERED, SLOT_PLACED, SLOT_WRITTEN } state;
    int rank;
    bool is_last; /* of its rank */
    uint64_t place;
    struct batch_entry entry;
};

/* Parts below `noted` are in the journal, those below `placed` have their place, those below `taken` a rank. Part n
 * has slot n % slots. */
struct coordinator {
    struct batch_file *kept; /* NULL once its journal could not be written */
    uint64_t noted, placed, taken;
    uint64_t size; /* of the file, with all that have a place */
    int ranks, ended;
    bool *has_ended; /* by rank */
    size_t slot_count;
    struct slot *slots;
};

static void sleep_briefly(void)
{
    static const struct timespec moment = {.tv_nsec = 100000};
    nanosleep(&moment, NULL);
}

static bool check_mpi(const struct ordered_file *file, int error)
{
    char text[MPI_MAX_ERROR_STRING];
    int length;
    if (error) {
        MPI_Error_string(error, text, &length);
        print_error_line("%s: cannot write: %s", file->path, text);
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

static void coordinator_destroy(struct coordinator *coordinator)
{
    if (coordinator) {
        free(coordinator->has_ended);
        free(coordinator->slots);
        free(coordinator);
    }
}

static struct coordinator *coordinator_create(struct batch_file *kept, uint64_t size)
{
    struct coordinator *coordinator = calloc(1, sizeof *coordinator);
    if (!coordinator) {
        return NULL;
    }
    coordinator->kept = kept;
    coordinator->size = size;
    MPI_Comm_size(MPI_COMM_WORLD, &coordinator->ranks);
    coordinator->slot_count = LEAST_SLOTS + 2 * (size_t)coordinator->ranks;
    coordinator->slots = calloc(coordinator->slot_count, sizeof *coordinator->slots);
    coordinator->has_ended = calloc((size_t)coordinator->ranks, sizeof *coordinator->has_ended);
    if (!coordinator->slots || !coordinator->has_ended) {
        coordinator_destroy(coordinator);
        return NULL;
    }
    return coordinator;
}

int ordered_file_open(struct ordered_file *out, const char *path, uint64_t size, struct batch_file *kept)
{
    struct ordered_file file = {.path = path, .coordinator = kept ? coordinator_create(kept, size) : NULL};
    char *part = NULL;
    int error = asprintf(&part, "%s.part", path) < 0 || (kept && !file.coordinator) ? MPI_ERR_NO_MEM : MPI_SUCCESS;
    int code = error;
    MPI_Allreduce(&error, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    if (!code) {
        error = MPI_File_open(MPI_COMM_WORLD, part, MPI_MODE_WRONLY, MPI_INFO_NULL, &file.file);
        MPI_Allreduce(&error, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    }
    free(part);
    if (code) {
        check_mpi(&file, error);
        coordinator_destroy(file.coordinator);
        return EXIT_DATA;
    }
    *out = file;
    return EXIT_DONE;
}

static struct slot *slot_of(struct coordinator *coordinator, uint64_t number)
{
    return &coordinator->slots[number % coordinator->slot_count];
}

static void send_reply(int rank, enum reply kind, uint64_t place, const uint64_t *next)
{
    const uint64_t message[REPLY_SIZE] = {kind, place, next ? *next : 0, next != NULL};
    MPI_Send(message, REPLY_SIZE, MPI_UINT64_T, rank, FROM_COORDINATOR, MPI_COMM_WORLD);
}

/* Sends the first reason to all; here a higher one replaces it. */
static void stop_all(struct ordered_file *file, int code)
{
    struct coordinator *coordinator = file->coordinator;
    for (int rank = 1; rank < coordinator->ranks && !file->stop; rank++) {
        if (!coordinator->has_ended[rank]) {
            send_reply(rank, STOPPED, (uint64_t)code, NULL);
        }
    }
    file->stop = code > file->stop ? code : file->stop;
}

static void handle_request(struct ordered_file *file, int rank, const uint64_t request[REQUEST_SIZE])
{
    struct coordinator *coordinator = file->coordinator;
    uint64_t next = coordinator->taken;
    switch ((enum request)request[KIND]) {
    case TAKE:
        if (!file->stop) {
            coordinator->taken++;
            send_reply(rank, GRANTED, 0, &next);
        }
        break;
    case ANSWERED:
    case ANSWERED_LAST:
        *slot_of(coordinator, request[NUMBER]) = (struct slot){
            .state = SLOT_ANSWERED,
            .rank = rank,
            .is_last = request[KIND] == ANSWERED_LAST,
            .entry = {request[POSES], request[ERRORS], request[SIZE], (uint32_t)request[CRC]},
        };
        break;
    case WRITTEN:
        slot_of(coordinator, request[NUMBER])->state = SLOT_WRITTEN;
        break;
    case STOP:
        stop_all(file, (int)request[NUMBER]);
        break;
    case END:
        coordinator->has_ended[rank] = true;
        coordinator->ended++;
        send_reply(rank, FAREWELL, 0, NULL);
        break;
    }
}

/* Gives places to parts in their order, and with each its rank the next one to answer. Parts that are answered are at
 * most one per rank, so that all have slots. */
static void place_parts(struct ordered_file *file)
{
    struct coordinator *coordinator = file->coordinator;
    struct slot *slot = slot_of(coordinator, coordinator->placed);
    while (!file->stop && slot->state == SLOT_ANSWERED &&
           coordinator->placed - coordinator->noted < coordinator->slot_count - (size_t)coordinator->ranks) {
        uint64_t next = coordinator->taken;
        slot->state = SLOT_PLACED;
        slot->place = coordinator->size;
        coordinator->size += slot->entry.size;
        coordinator->placed++;
        if (slot->rank) {
            coordinator->taken += !slot->is_last;
            send_reply(slot->rank, PLACED, slot->place, slot->is_last ? NULL : &next);
        }
        slot = slot_of(coordinator, coordinator->placed);
    }
}

static void fill_journal(struct ordered_file *file)
{
    struct coordinator *coordinator = file->coordinator;
    struct slot *slot = slot_of(coordinator, coordinator->noted);
    while (coordinator->kept && slot->state == SLOT_WRITTEN) {
        int code = slot->entry.poses ? batch_file_note(coordinator->kept, &slot->entry) : EXIT_DONE;
        if (code) {
            coordinator->kept = NULL;
            stop_all(file, code);
            return;
        }
        slot->state = SLOT_FREE;
        coordinator->noted++;
        slot = slot_of(coordinator, coordinator->noted);
    }
}

static void serve_requests(struct ordered_file *file)
{
    MPI_Status status;
    int is_there;
    for (;;) {
        uint64_t request[REQUEST_SIZE];
        MPI_Iprobe(MPI_ANY_SOURCE, TO_COORDINATOR, MPI_COMM_WORLD, &is_there, &status);
        if (!is_there) {
            break;
        }
        MPI_Recv(request, REQUEST_SIZE, MPI_UINT64_T, status.MPI_SOURCE, TO_COORDINATOR, MPI_COMM_WORLD, &status);
        handle_request(file, status.MPI_SOURCE, request);
    }
    fill_journal(file);
    place_parts(file);
}

static void send_request(enum request kind, uint64_t number, const struct batch_entry *entry)
{
    static const struct batch_entry none;
    const struct batch_entry *e = entry ? entry : &none;
    const uint64_t request[REQUEST_SIZE] = {kind, number, e->poses, e->errors, e->size, e->crc};
    MPI_Send(request, REQUEST_SIZE, MPI_UINT64_T, 0, TO_COORDINATOR, MPI_COMM_WORLD);
}

/* Receives a reply of rank 0, if there is one; notes that all are to stop. */
static bool receive_reply(struct ordered_file *file, uint64_t message[REPLY_SIZE])
{
    int is_there;
    MPI_Iprobe(0, FROM_COORDINATOR, MPI_COMM_WORLD, &is_there, MPI_STATUS_IGNORE);
    if (!is_there) {
        return false;
    }
    MPI_Recv(message, REPLY_SIZE, MPI_UINT64_T, 0, FROM_COORDINATOR, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (message[KIND] == STOPPED) {
        file->stop = (int)message[PLACE];
    }
    return true;
}

void ordered_file_stop(struct ordered_file *file, int code)
{
    if (file->coordinator) {
        stop_all(file, code);
    } else if (!file->stop) {
        send_request(STOP, (uint64_t)code, NULL);
        file->stop = code;
    }
}

static void check_signals(struct ordered_file *file)
{
    if (interrupt_signal() && !file->stop) {
        ordered_file_stop(file, 128 + interrupt_signal());
    }
}

bool ordered_file_tend(struct ordered_file *file)
{
    uint64_t message[REPLY_SIZE];
    check_signals(file);
    if (file->coordinator) {
        serve_requests(file);
    } else {
        receive_reply(file, message); /* nothing has been asked: it can only be STOPPED */
    }
    return !file->stop;
}

/* Waits for what rank 0 has been asked; false when all are to stop. */
static bool wait_for_reply(struct ordered_file *file, uint64_t message[REPLY_SIZE])
{
    while (!file->stop) {
        if (receive_reply(file, message)) {
            return !file->stop;
        }
        sleep_briefly();
        check_signals(file);
    }
    return false;
}

bool ordered_file_take(struct ordered_file *file, uint64_t *number)
{
    uint64_t message[REPLY_SIZE];
    if (file->stop) {
        return false;
    }
    if (file->coordinator) {
        *number = file->coordinator->taken++;
        return true;
    }
    if (!file->has_next) {
        send_request(TAKE, 0, NULL);
        if (!wait_for_reply(file, message)) {
            return false;
        }
        file->next = message[NEXT];
    }
    file->has_next = false;
    *number = file->next;
    return true;
}

static bool find_place(struct ordered_file *file, uint64_t number, const struct batch_entry *entry, bool is_last,
                       uint64_t *place)
{
    uint64_t message[REPLY_SIZE];
    if (file->coordinator) {
        /* Rank 0 asks itself. */
        struct slot *slot = slot_of(file->coordinator, number);
        *slot = (struct slot){.state = SLOT_ANSWERED, .entry = *entry};
        while (ordered_file_tend(file) && slot->state == SLOT_ANSWERED) {
            sleep_briefly();
        }
        *place = slot->place;
        return !file->stop;
    }
    send_request(is_last ? ANSWERED_LAST : ANSWERED, number, entry);
    if (!wait_for_reply(file, message)) {
        return false;
    }
    *place = message[PLACE];
    file->next = message[NEXT];
    file->has_next = message[HAS_NEXT];
    return true;
}

void ordered_file_write(struct ordered_file *file, uint64_t number, const conus_batch_block *part, bool is_last)
{
    const struct batch_entry entry = batch_entry_of(part);
    uint64_t place;
    if (file->stop || !find_place(file, number, &entry, is_last, &place)) {
        return;
    }
    if (!check_mpi(file, write_at(file->file, place, part->text, part->size))) {
        ordered_file_stop(file, EXIT_DATA);
    } else if (file->coordinator) {
        slot_of(file->coordinator, number)->state = SLOT_WRITTEN;
    } else {
        send_request(WRITTEN, number, NULL);
    }
}

void ordered_file_wait(struct ordered_file *file)
{
    const struct coordinator *coordinator = file->coordinator;
    while (ordered_file_tend(file) &&
           (coordinator->ended < coordinator->ranks - 1 || coordinator->noted < coordinator->placed)) {
        sleep_briefly();
    }
}

/* After this there are no more messages. */
static void end_messages(struct ordered_file *file)
{
    uint64_t message[REPLY_SIZE] = {STOPPED};
    if (file->coordinator) {
        while (file->coordinator->ended < file->coordinator->ranks - 1) {
            serve_requests(file);
            sleep_briefly();
        }
        return;
    }
    send_request(END, 0, NULL);
    while (message[KIND] != FAREWELL) {
        if (!receive_reply(file, message)) {
            sleep_briefly();
        }
    }
}

int ordered_file_close(struct ordered_file *file)
{
    end_messages(file);
    int error = MPI_File_sync(file->file);
    int closed = MPI_File_close(&file->file);
    bool whole = check_mpi(file, error ? error : closed);
    coordinator_destroy(file->coordinator);
    return whole || file->stop ? file->stop : EXIT_DATA;
}
