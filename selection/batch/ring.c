/* SPDX-License-Identifier: BSD-3-Clause */
/* The threads that answer the blocks of a run. */
#include "selection/batch/batch.h"

#include "base/memory.h"
#include "base/status.h"
#include "base/system/system.h"

#include <pthread.h>
#include <stdio.h>

enum { STACK = 1 << 20 }; /* bytes of a thread */

struct slot {
    bool is_answered;
    conus_status status; /* of reading and answering */
    char message[1024];  /* kept, since it belongs to a thread */
};

/* Block number n, counted from 0, lies in slot n modulo their count. Blocks below `delivered` are free to be read into;
 * of the others those are answered that is_answered marks. */
struct pool {
    const struct ring *ring;
    pthread_mutex_t reading; /* held by the one thread that reads */
    pthread_mutex_t lock;    /* guards the members below */
    pthread_cond_t answered, freed;
    struct slot *slots; /* [ring->slots] */
    uint64_t taken, delivered;
    bool ended; /* no block follows those that are taken */
    atomic_bool stop;
    const struct slot *failed; /* why, once `stop` */
    size_t hired;              /* workers that have been handed out to threads */
};

static void keep_status(struct slot *slot, conus_status status)
{
    slot->status = status;
    if (status) {
        snprintf(slot->message, sizeof slot->message, "%s", conus_message());
    }
}

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
        pool->slots[*slot].is_answered = false;
    }
    pthread_mutex_unlock(&pool->lock);
    if (!go_on) {
        return false;
    }
    bool may_follow = false;
    keep_status(&pool->slots[*slot], ring->read(ring->user, *slot, &may_follow));
    pthread_mutex_lock(&pool->lock);
    pool->taken++;
    pool->ended = !may_follow || pool->slots[*slot].status;
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
        size_t n;
        pthread_mutex_lock(&pool->reading);
        bool is_read = read_next(pool, &n);
        pthread_mutex_unlock(&pool->reading);
        if (!is_read) {
            return NULL;
        }
        struct slot *slot = &pool->slots[n];
        if (!slot->status) {
            keep_status(slot, pool->ring->answer(pool->ring->user, n, worker, &pool->stop));
        }
        pthread_mutex_lock(&pool->lock);
        slot->is_answered = true;
        pthread_cond_signal(&pool->answered);
        pthread_mutex_unlock(&pool->lock);
    }
}

/* Stacks do not depend on `ulimit -s`. */
static size_t start_threads(struct pool *pool, pthread_t *threads, size_t wanted)
{
    size_t count = 0;
    while (count < wanted && system_thread(&threads[count], STACK, work, pool)) {
        count++;
    }
    return count;
}

static void deliver_all(struct pool *pool)
{
    const struct ring *ring = pool->ring;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stop) {
        size_t n = (size_t)(pool->delivered % ring->slots);
        struct slot *slot = &pool->slots[n];
        while (pool->delivered == pool->taken ? !pool->ended : !slot->is_answered) {
            pthread_cond_wait(&pool->answered, &pool->lock);
        }
        if (pool->delivered == pool->taken) {
            break;
        }
        pthread_mutex_unlock(&pool->lock);
        if (!slot->status) {
            keep_status(slot, ring->deliver(ring->user, n));
        }
        pthread_mutex_lock(&pool->lock);
        pool->stop = slot->status != CONUS_OK;
        pool->failed = pool->stop ? slot : NULL;
        pool->delivered++;
        if (pool->stop && !pool->ended && ring->interrupt) {
            ring->interrupt(ring->user);
        }
        pthread_cond_broadcast(&pool->freed);
    }
    pthread_mutex_unlock(&pool->lock);
}

static conus_status run_alone(const struct ring *ring)
{
    static const atomic_bool never = false;
    bool may_follow = true;
    conus_status status = CONUS_OK;
    while (may_follow && !status) {
        may_follow = false;
        status = ring->read(ring->user, 0, &may_follow);
        status = status ? status : ring->answer(ring->user, 0, 0, &never);
        status = status ? status : ring->deliver(ring->user, 0);
    }
    return status;
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
    return !count         ? run_alone(pool->ring) /* there are no threads, in WebAssembly, or no more */
           : pool->failed ? fail(pool->failed->status, "%s", pool->failed->message)
                          : CONUS_OK;
}

conus_status ring_run(const struct ring *ring)
{
    if (ring->workers == 1) {
        return run_alone(ring);
    }
    struct pool pool = {.ring = ring, .slots = memory_zeroed(ring->slots, sizeof *pool.slots)};
    pthread_t *threads = memory_zeroed(ring->workers, sizeof *threads);
    conus_status status = pool.slots && threads ? run_threads(&pool, threads) : CONUS_ERROR_MEMORY;
    memory_free(pool.slots);
    memory_free(threads);
    return status;
}
