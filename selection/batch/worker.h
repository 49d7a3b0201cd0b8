/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The selector and scratch of one thread of a batch. */
#ifndef CONUS_SELECTION_BATCH_WORKER_H
#define CONUS_SELECTION_BATCH_WORKER_H

#include "conus/selection.h"
#include "conus/study.h"
#include "selection/study/study.h"

#include <stdatomic.h>

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
