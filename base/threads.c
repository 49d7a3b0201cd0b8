/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts threads for the pieces of some work, and waits for them. */
#include "base/threads.h"

#include "base/system/system.h"

size_t threads_for(uint64_t count, uint64_t least)
{
    uint64_t processors = system_processors();
    uint64_t wanted = count / least;
    wanted = wanted < processors ? wanted : processors;
    wanted = wanted < THREADS_MOST ? wanted : THREADS_MOST;
    return wanted ? (size_t)wanted : 1;
}

static void *run(void *user)
{
    const struct thread_piece *piece = user;
    piece->work(piece->user, piece->number);
    return NULL;
}

void threads_start(struct thread_piece *out, threads_work *work, void *user, size_t piece)
{
    *out = (struct thread_piece){.work = work, .user = user, .number = piece};
    out->has_thread = system_thread(&out->thread, 0, run, out);
}

void threads_wait(struct thread_piece *piece)
{
    if (piece->has_thread) {
        pthread_join(piece->thread, NULL);
    } else if (piece->work) {
        piece->work(piece->user, piece->number);
    }
    *piece = (struct thread_piece){0};
}

void threads_run(threads_work *work, void *user, size_t count)
{
    struct thread_piece pieces[THREADS_MOST];
    for (size_t i = 0; i + 1 < count; i++) {
        threads_start(&pieces[i], work, user, i);
    }
    work(user, count - 1);
    for (size_t i = 0; i + 1 < count; i++) {
        threads_wait(&pieces[i]);
    }
}

struct parts {
    threads_test *check;
    const void *user;
    size_t count, pieces;
    bool is_sound[THREADS_MOST];
};

static void check_part(void *user, size_t piece)
{
    struct parts *parts = user;
    parts->is_sound[piece] = parts->check(parts->user, threads_begin(piece, parts->pieces, parts->count, 1),
                                          threads_begin(piece + 1, parts->pieces, parts->count, 1));
}

bool threads_check(threads_test *check, const void *user, size_t count, size_t least)
{
    struct parts parts = {.check = check, .user = user, .count = count, .pieces = threads_for(count, least)};
    bool sound = true;
    threads_run(check_part, &parts, parts.pieces);
    for (size_t i = 0; i < parts.pieces; i++) {
        sound = sound && parts.is_sound[i];
    }
    return sound;
}
