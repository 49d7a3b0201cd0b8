/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts threads for the pieces of some work, and waits for them. */
#include "base/threads.h"

#include <sched.h>
#include <signal.h>

size_t threads_for(uint64_t count, uint64_t least)
{
#ifdef __EMSCRIPTEN__ /* whose pages have no threads here */
    uint64_t processors = 1;
#else
    cpu_set_t set;
    uint64_t processors = sched_getaffinity(0, sizeof set, &set) == 0 ? (uint64_t)CPU_COUNT(&set) : 1;
#endif
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

/* Signals are for the program's own threads. */
void threads_start(struct thread_piece *out, threads_work *work, void *user, size_t piece)
{
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    *out = (struct thread_piece){.work = work, .user = user, .number = piece};
    pthread_sigmask(SIG_SETMASK, &all, &before);
    out->has_thread = pthread_create(&out->thread, NULL, run, out) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
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
