/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Blocks are read in their order, answered in any order by several threads, and delivered in their order. So the result
 * depends only on what was read, not on which thread answers when. */
#ifndef CONUS_SELECTION_BATCH_RING_H
#define CONUS_SELECTION_BATCH_RING_H

#include "conus/status.h"

#include <stdatomic.h>

/** The steps for the block in a slot. Each function gets @p user. */
struct ring {
    void *user;
    size_t workers; /**< 1 = the calling thread does all, as where no other can be started; else each is a thread. */
    size_t slots;   /**< ring_slots(workers) */

    /** Fills the slot; @p may_follow: whether there may be another block. One thread at a time. */
    conus_status (*read)(void *user, size_t slot, bool *may_follow);

    /** Answers what was read. May give up once @p stop. */
    conus_status (*answer)(void *user, size_t slot, size_t worker, const atomic_bool *stop);

    /** Takes the answers, on the calling thread. */
    conus_status (*deliver)(void *user, size_t slot);

    /** Makes a read() that waits return, after deliver() has ended the run. NULL = it never waits. */
    void (*interrupt)(void *user);
};

/** More than workers, so that nobody waits for the one block that is late; 1 for one worker. */
static inline size_t ring_slots(size_t workers)
{
    return workers == 1 ? 1 : 2 * workers + 2;
}

/** Reads, answers and delivers until there is nothing more to read, or until a step fails. Then the blocks before the
 * one that failed have been delivered; the status and its message are of that block. */
conus_status ring_run(const struct ring *ring);

#endif
