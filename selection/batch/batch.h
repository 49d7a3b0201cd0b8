/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Batches: blocks in their order, and the scratch of a thread that answers them. */
#ifndef CONUS_SELECTION_BATCH_BATCH_H
#define CONUS_SELECTION_BATCH_BATCH_H

#include "conus/selection.h"
#include "conus/status.h"
#include "conus/study.h"
#include "selection/study/study.h"

#include <stdatomic.h>

/* Blocks are read in their order, answered in any order by several threads, and delivered in their order. So the
 * result depends only on what was read, not on which thread answers when. */

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

/* The selector and scratch of one thread of a batch. */

/** A pose of a block. */
struct batch_pose {
    conus_pose pose;
    double angle;    /**< 0 = the worker's. */
    double range[2]; /**< mm; NaN = that of the worker's selector. */
    double radius;   /**< Of the ball around a point, mm; NaN = that of batch_points. */
    size_t line;     /**< Its number for the caller: a line of a file, say. */
    bool is_no_pose;
    bool is_point;
};

/** How poses that are points are asked. */
struct batch_points {
    double radius;     /**< Of the ball, mm; 0 = what is at the point. */
    const char *error; /**< Why they are not; NULL = they are. Not owned. */
};

enum { BATCH_BLOCK_LIMIT = 65536 };

/** Checks how poses are to be answered, and sets defaults where a value is 0: @p threads by the processors that the
 * process may use,
 * @p block, and @p angle. */
conus_status batch_check_options(uint32_t *threads, uint32_t *block, double *angle, const conus_selector *selector);

struct batch_worker {
    conus_selector *selector; /**< Shares its engine with the other workers'. */
    double angle;
    struct batch_points points;
    conus_selection **begun;      /**< [at_once] Those that are traced together; NULL between blocks. */
    size_t at_once;               /**< 1 = poses are answered one by one. */
    struct conus_pose_check aims; /**< Findings about the poses answered. */
};

/** Zeroed, for poses by blocks of up to @p block; @p angle is for poses without one. */
conus_status batch_worker_init(struct batch_worker *out, conus_selector *selector, size_t block, double angle,
                               struct batch_points points);
void batch_worker_finish(struct batch_worker *worker);

/** Takes the answer to pose @p index: a selection, which the caller destroys. NULL where the pose is wrong; then
 * conus_message() says why, unless the row is no pose at all. */
typedef conus_status batch_take(void *user, size_t index, const conus_selection *selection);

/** Answers the poses in their order, and counts how they aim. Gives up once @p stop. A pose at fault is an answer, not
 * a failure. */
conus_status batch_worker_answer(struct batch_worker *worker, const struct batch_pose *poses, size_t count,
                                 const atomic_bool *stop, batch_take *take, void *user);

/** Takes the answer about the axis of pose @p index, which the caller destroys. NULL where the pose is wrong or has no
 * axis; then conus_message() says why, unless the row is no pose at all. */
typedef conus_status batch_take_axis(void *user, size_t index, conus_table *table);

/** batch_worker_answer() for the axes of the poses: their segments or, unless @p within is NULL, their clearances up
 * to *within mm. */
conus_status batch_worker_answer_axes(struct batch_worker *worker, const struct batch_pose *poses, size_t count,
                                      const atomic_bool *stop, const double *within, batch_take_axis *take, void *user);

#endif
