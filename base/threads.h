/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Work that is shared out among threads. */
#ifndef CONUS_BASE_THREADS_H
#define CONUS_BASE_THREADS_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { THREADS_MOST = 16 };

/** How many threads are worth while for @p count items, each at least @p least of them: 1 to THREADS_MOST, and no more
 * than there are processors for this process. */
size_t threads_for(uint64_t count, uint64_t least);

/** Does a piece of the work, from 0 on. It has no result but what it writes where no other piece reads or writes. */
typedef void threads_work(void *user, size_t piece);

/** Does @p count pieces at once, up to THREADS_MOST, the last one on this thread, and waits for all. Where no thread
 * can be started, its piece is done here. */
void threads_run(threads_work *work, void *user, size_t count);

/** Whether @p check holds for all of @p count things at @p user; threads take parts of them, of @p least or more. */
typedef bool threads_test(const void *user, size_t from, size_t to);
bool threads_check(threads_test *check, const void *user, size_t count, size_t least);

/** A piece under way. A zeroed one is none. */
struct thread_piece {
    threads_work *work;
    void *user;
    size_t number;
    pthread_t thread;
    bool has_thread;
};

/** Begins a piece on another thread. It is done by the time that threads_wait() returns: there, if none can be started.
 * Whoever starts one has to wait for it. */
void threads_start(struct thread_piece *out, threads_work *work, void *user, size_t piece);
void threads_wait(struct thread_piece *piece);

/** Where piece @p piece of @p pieces begins among @p count items; at a multiple of @p step, or at the end. */
static inline size_t threads_begin(size_t piece, size_t pieces, size_t count, size_t step)
{
    size_t blocks = count / step + (count % step != 0);
    size_t begin = (blocks / pieces * piece + blocks % pieces * piece / pieces) * step;
    return begin < count ? begin : count;
}

#endif
