/* SPDX-License-Identifier: BSD-3-Clause */
/* The threads that answer the blocks of a run. */
#include "selection/batch/ring.h"

#include "base/memory.h"
#include "base/status.h"

#include <pthread.h>
#include <signal.h>

enum { STACK = 1 << 20 }; /* bytes of a thread */

/* Block number n, counted from 0, lies in slot n modulo their count. Blocks below `delivered` are free to be read into;
 * of the others those are answered that is_answered marks. */
struct pool {
    const struct ring *ring;
    pthread_mutex_t reading; /* held by the one thread that reads */
    pthread_mutex_t lock;    /* of what follows */
    pthread_cond_t answered, freed;
    bool *is_answered; /* [slots] */
    uint64_t taken, delivered;
    bool ended; /* no block follows those that are taken */
    atomic_bool stop;
    size_t hired; /* workers that have been handed out to threads */
};

/* Waits for a free slot and reads a block into it; false when there is nothing more to do. Only one thread is here at a
 * time. */
static bool read_next(struct pool *pool, size_t *slot)
{
    const struct ring *ring = pool->ring;
    pthread_mutex_lock(&pool->lock);
    while (!pool->ended && !pool->stop && pool->taken - pool->delivered == ring->slots) {
        pthread_cond_wait(&pool->freed, &pool->lock);
    }
    bool go_on = !pool->ended && !pool->stop;
    if (go_on) {
        *slot = (size_t)(pool->taken % ring->slots);
        pool->is_answered[*slot] = false;
    }
    pthread_mutex_unlock(&pool->lock);
    if (!go_on) {
        return false;
    }
    bool may_follow = ring->read(ring->user, *slot);
    pthread_mutex_lock(&pool->lock);
    pool->taken++;
    pool->ended = !may_follow;
    pthread_mutex_unlock(&pool->lock);
    return true;
}

static void *work(void *data)
{
    struct pool *pool = data;
    pthread_mutex_lock(&pool->lock);
    size_t worker = pool->hired++;
    pthread_mutex_unlock(&pool->lock);
    for (;;) {
        size_t slot;
        pthread_mutex_lock(&pool->reading);
        bool is_read = read_next(pool, &slot);
        pthread_mutex_unlock(&pool->reading);
        if (!is_read) {
            return NULL;
        }
        pool->ring->answer(pool->ring->user, slot, worker, &pool->stop);
        pthread_mutex_lock(&pool->lock);
        pool->is_answered[slot] = true;
        pthread_cond_signal(&pool->answered);
        pthread_mutex_unlock(&pool->lock);
    }
}

/* Signals are for the program's own threads. Stacks do not depend on `ulimit -s`. */
static size_t start_threads(struct pool *pool, pthread_t *threads, size_t wanted)
{
    sigset_t all;
    sigset_t before;
    pthread_attr_t attributes;
    size_t count = 0;
    if (pthread_attr_init(&attributes)) {
        return 0;
    }
    (void)pthread_attr_setstacksize(&attributes, STACK);
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (count < wanted && pthread_create(&threads[count], &attributes, work, pool) == 0) {
        count++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return count;
}

/* Waits for the next block to be delivered; false where none comes. */
static bool wait_for_answers(struct pool *pool, size_t *slot)
{
    *slot = (size_t)(pool->delivered % pool->ring->slots);
    while (pool->delivered == pool->taken ? !pool->ended : !pool->is_answered[*slot]) {
        pthread_cond_wait(&pool->answered, &pool->lock);
    }
    return pool->delivered != pool->taken;
}

static void deliver_all(struct pool *pool)
{
    const struct ring *ring = pool->ring;
    size_t slot;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stop && wait_for_answers(pool, &slot)) {
        pthread_mutex_unlock(&pool->lock);
        bool go_on = ring->deliver(ring->user, slot);
        pthread_mutex_lock(&pool->lock);
        pool->delivered++;
        pool->stop = !go_on;
        if (pool->stop && !pool->ended && ring->interrupt) {
            ring->interrupt(ring->user);
        }
        pthread_cond_broadcast(&pool->freed);
    }
    pthread_mutex_unlock(&pool->lock);
}

static void run_alone(const struct ring *ring)
{
    static const atomic_bool never = false;
    bool go_on = true;
    while (go_on) {
        go_on = ring->read(ring->user, 0);
        ring->answer(ring->user, 0, 0, &never);
        go_on = ring->deliver(ring->user, 0) && go_on;
    }
}

static conus_status run_threads(struct pool *pool, pthread_t *threads)
{
    pthread_mutex_init(&pool->reading, NULL);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->answered, NULL);
    pthread_cond_init(&pool->freed, NULL);
    size_t count = start_threads(pool, threads, pool->ring->workers);
    if (count) {
        deliver_all(pool);
    }
    for (size_t i = 0; i < count; i++) {
        pthread_join(threads[i], NULL);
    }
    pthread_cond_destroy(&pool->freed);
    pthread_cond_destroy(&pool->answered);
    pthread_mutex_destroy(&pool->lock);
    pthread_mutex_destroy(&pool->reading);
    return count ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "threads: the system cannot start one");
}

conus_status ring_run(const struct ring *ring)
{
    if (ring->workers == 1) {
        run_alone(ring);
        return CONUS_OK;
    }
    struct pool pool = {.ring = ring, .is_answered = memory_zeroed(ring->slots, sizeof *pool.is_answered)};
    pthread_t *threads = memory_zeroed(ring->workers, sizeof *threads);
    conus_status status = pool.is_answered && threads ? run_threads(&pool, threads) : CONUS_ERROR_MEMORY;
    memory_free(pool.is_answered);
    memory_free(threads);
    return status;
}
