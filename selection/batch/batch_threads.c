/* SPDX-License-Identifier: BSD-3-Clause */
/* The threads that answer the blocks of a run, in a ring. */
#include "base/memory.h"
#include "selection/batch/batch.h"

#include <pthread.h>
#include <signal.h>

/* Blocks lie in a ring: number n, counted from 0, in slot n modulo their count. They are read in their order, answered
 * in any, and delivered in their order. Numbers below `delivered` are free to be read into. */
struct pool {
    struct batch_run *run;
    pthread_mutex_t reading; /* held by the one thread that reads poses */
    pthread_mutex_t lock;    /* of what follows */
    pthread_cond_t answered, freed;
    uint64_t taken, delivered;
    bool ended; /* no block follows those that are taken */
    atomic_bool stop;
    uint32_t hired; /* workers that have been handed out to threads */
};

static struct batch_block *block_number(const struct pool *pool, uint64_t number)
{
    const conus_batch *batch = pool->run->batch;
    return &batch->blocks[number % batch->block_count];
}

/* Waits for a free block and reads it; NULL when there is nothing more to do. Only one thread is here at a time. */
static struct batch_block *read_next(struct pool *pool)
{
    struct batch_block *block = NULL;
    pthread_mutex_lock(&pool->lock);
    while (!pool->ended && !pool->stop && pool->taken - pool->delivered == pool->run->batch->block_count) {
        pthread_cond_wait(&pool->freed, &pool->lock);
    }
    bool go_on = !pool->ended && !pool->stop;
    pthread_mutex_unlock(&pool->lock);
    if (!go_on) {
        return NULL;
    }
    block = block_number(pool, pool->taken);
    batch_block_read(block, pool->run->poses, pool->run->left);
    pool->run->left -= block->count;
    pthread_mutex_lock(&pool->lock);
    pool->taken++;
    pool->ended = block->status || block->count < block->capacity;
    pthread_mutex_unlock(&pool->lock);
    return block;
}

static void *work(void *data)
{
    struct pool *pool = data;
    pthread_mutex_lock(&pool->lock);
    struct batch_worker *worker = &pool->run->batch->workers[pool->hired++];
    pthread_mutex_unlock(&pool->lock);
    for (;;) {
        pthread_mutex_lock(&pool->reading);
        struct batch_block *block = read_next(pool);
        pthread_mutex_unlock(&pool->reading);
        if (!block) {
            return NULL;
        }
        batch_block_answer(block, worker, &pool->stop);
        pthread_mutex_lock(&pool->lock);
        block->is_done = true;
        pthread_cond_signal(&pool->answered);
        pthread_mutex_unlock(&pool->lock);
    }
}

/* Signals are for the program's own threads. */
static uint32_t start_threads(struct pool *pool, pthread_t *threads, uint32_t wanted)
{
    sigset_t all;
    sigset_t before;
    uint32_t count = 0;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (count < wanted && pthread_create(&threads[count], NULL, work, pool) == 0) {
        count++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return count;
}

/* Hands out blocks until the run ends; gives the one it ended with. */
static const struct batch_block *deliver(struct pool *pool)
{
    const struct batch_block *block;
    bool go_on;
    do {
        pthread_mutex_lock(&pool->lock);
        block = block_number(pool, pool->delivered);
        while (pool->delivered == pool->taken || !block->is_done) {
            pthread_cond_wait(&pool->answered, &pool->lock);
        }
        pthread_mutex_unlock(&pool->lock);
        go_on = batch_run_deliver(pool->run, block);
        pthread_mutex_lock(&pool->lock);
        pool->delivered += go_on;
        pool->stop = !go_on;
        if (pool->stop && !pool->ended) { /* a worker may wait for a pipe */
            conus_pose_stream_stop(pool->run->poses);
        }
        pthread_cond_broadcast(&pool->freed);
        pthread_mutex_unlock(&pool->lock);
    } while (go_on);
    return block;
}

conus_status batch_run_threads(struct batch_run *run)
{
    struct pool pool = {.run = run};
    uint32_t wanted = (uint32_t)run->batch->worker_count;
    pthread_t *threads = memory_zeroed(wanted, sizeof *threads);
    if (!threads) {
        return CONUS_ERROR_MEMORY;
    }
    pthread_mutex_init(&pool.reading, NULL);
    pthread_mutex_init(&pool.lock, NULL);
    pthread_cond_init(&pool.answered, NULL);
    pthread_cond_init(&pool.freed, NULL);
    uint32_t count = start_threads(&pool, threads, wanted);
    conus_status status = count ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "threads: the system cannot start one");
    const struct batch_block *last = status ? NULL : deliver(&pool);
    for (uint32_t i = 0; i < count; i++) {
        pthread_join(threads[i], NULL);
    }
    if (last && last->status) {
        status = fail(last->status, "%s", last->message);
    }
    pthread_cond_destroy(&pool.freed);
    pthread_cond_destroy(&pool.answered);
    pthread_mutex_destroy(&pool.lock);
    pthread_mutex_destroy(&pool.reading);
    memory_free(threads);
    return status;
}
