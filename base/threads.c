/* SPDX-License-Identifier: BSD-3-Clause */
/* Starts threads for the pieces of some work, and waits for them. */
#include "base/threads.h"

#include <pthread.h>
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

struct piece {
    threads_work *work;
    void *user;
    size_t number;
    pthread_t thread;
    int failed; /* to start */
};

static void *run(void *user)
{
    const struct piece *piece = user;
    piece->work(piece->user, piece->number);
    return NULL;
}

/* Signals are for the program's own threads. */
void threads_run(threads_work *work, void *user, size_t count)
{
    struct piece pieces[THREADS_MOST];
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    for (size_t i = 0; i + 1 < count; i++) {
        pieces[i] = (struct piece){.work = work, .user = user, .number = i};
        pieces[i].failed = pthread_create(&pieces[i].thread, NULL, run, &pieces[i]);
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    work(user, count - 1);
    for (size_t i = 0; i + 1 < count; i++) {
        if (pieces[i].failed) {
            work(user, i);
        } else {
            pthread_join(pieces[i].thread, NULL);
        }
    }
}
