/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses of a stream in, rows of text out, by blocks. */
#ifndef CONUS_SELECTION_BATCH_BATCH_H
#define CONUS_SELECTION_BATCH_BATCH_H

#include "base/buffer.h"
#include "selection/batch/worker.h"
#include "selection/report/report.h"

struct batch_block {
    struct batch_pose *poses; /**< [capacity] */
    struct batch_words {
        size_t id;    /**< Where in the block's strings the pose's id begins, */
        size_t error; /**< and why it is no pose, if it is none. */
    } * words;        /**< [capacity] */
    size_t count, capacity;
    uint64_t first;        /**< Number of the first one in the stream, from 0. */
    struct buffer strings; /**< With a NUL behind each. */
    struct buffer text;    /**< The rows. */
    uint64_t errors;
    uint64_t error_line; /**< Of the first of these, */
    char error[512];     /**< and why it has no answer. */
    conus_status status; /**< Of reading and answering; where it is not CONUS_OK, the message is kept, too, since that
                              belongs to a thread. */
    char message[1024];
};

conus_status batch_block_init(struct batch_block *out, size_t capacity);
void batch_block_finish(struct batch_block *block);

/** Keeps the status, with its message, unless an earlier one is kept. */
void batch_block_set_status(struct batch_block *block, conus_status status);

/** Fills the block with the next poses, at most @p limit and its capacity. Sets its status. */
void batch_block_read(struct batch_block *block, conus_pose_stream *poses, uint64_t limit);

/** What answers for one atlas. */
struct batch_atlas {
    struct batch_worker *workers; /**< [conus_batch.options.threads] */
    conus_report **reports;       /**< [conus_batch.options.threads] Those of the first atlas join the others'. */
};

/** Answers the block's poses into its text, by worker @p worker of each atlas. Sets its status. Gives up, with part of
 * the text, once @p stop. */
void batch_block_answer(struct batch_block *block, const struct batch_atlas *atlases, size_t atlas_count, size_t worker,
                        const atomic_bool *stop);

struct conus_batch {
    conus_batch_options options; /**< Defaults filled in. */
    conus_frame frame;           /**< That of options.report, where it has one. */
    struct batch_atlas *atlases; /**< [atlas_count] */
    size_t atlas_count, atlas_capacity;
    struct batch_block *blocks; /**< [block_count] */
    size_t block_count;
    struct buffer header;
};

#endif
