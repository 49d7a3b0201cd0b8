/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Poses in, rows out, by blocks. A block is read in one go, answered by one worker on its own, and delivered when all
 * before it have been: so its text depends on nothing but its poses, whoever answers it and when. */
#ifndef CONUS_SELECTION_BATCH_BATCH_H
#define CONUS_SELECTION_BATCH_BATCH_H

#include "base/buffer.h"
#include "selection/report/report.h"
#include "selection/study/aims.h"

#include <stdatomic.h>

/** A pose of a block. */
struct batch_pose {
    conus_pose pose;
    double angle; /**< 0 = the batch's. */
    size_t line;  /**< In its file.     */
    size_t id;    /**< Where in the block's strings its id begins, */
    size_t error; /**< and why it is no pose, if it is none.        */
    bool is_no_pose;
    bool is_point;
};

struct batch_block {
    struct batch_pose *poses; /**< [capacity] */
    size_t count, capacity;
    uint64_t first;        /**< Number of the first one in the stream, from 0. */
    struct buffer strings; /**< With a NUL behind each. */
    struct buffer text;    /**< The rows. */
    uint64_t errors;
    conus_status status; /**< Of reading and answering; where it is not CONUS_OK, the message is kept, too, since that
                              belongs to a thread. */
    char message[1024];
    bool is_done; /**< Answered; of batch_threads.c. */
};

conus_status batch_block_init(struct batch_block *out, size_t capacity);
void batch_block_finish(struct batch_block *block);

/** Fills the block with the next poses, at most @p limit and its capacity. Sets its status. */
void batch_block_read(struct batch_block *block, conus_pose_stream *poses, uint64_t limit);

/** What one thread answers with. */
struct batch_worker {
    conus_selector *selector; /**< Shares its engine with the other workers'. */
    conus_report *report;
    double angle;
    conus_selection **begun; /**< [at_once] Those that are traced together; NULL between blocks. */
    size_t at_once;          /**< 1 = poses are answered one by one. */
    struct conus_aims aims;
};

/** Answers the block's poses into its text. Sets its status. Gives up, leaving the text as it is, once @p stop. */
void batch_block_answer(struct batch_block *block, struct batch_worker *worker, const atomic_bool *stop);

struct conus_batch {
    conus_batch_options options; /**< Defaults filled in. */
    struct batch_worker *workers;
    size_t worker_count;
    struct batch_block *blocks;
    size_t block_count; /**< More than workers, so that nobody waits for the one block that is late. */
    struct buffer header;
    struct conus_aims aims; /**< What each worker begins with. */
};

/** Where a run has got to. */
struct batch_run {
    conus_batch *batch;
    conus_pose_stream *poses;
    uint64_t left; /**< Poses still to be read. */
    conus_batch_sink sink;
    void *user;
};

/** Reports the block; false if the run ends with it, be it by the sink's wish. */
bool batch_run_deliver(const struct batch_run *run, const struct batch_block *block);

/** The run with all workers, each in a thread of its own, and deliveries by the calling one. */
conus_status batch_run_threads(struct batch_run *run);

#endif
