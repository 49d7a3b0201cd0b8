/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses of arrays in, arrays of results out, by blocks. */
#include "selection/batch/ring.h"
#include "selection/batch/worker.h"

#include "base/memory.h"
#include "base/options.h"
#include "base/status.h"

#include <string.h>

struct block {
    struct batch_pose *poses; /* [capacity] */
    size_t *starts;           /* [capacity + 1] */
    conus_status *statuses;   /* [capacity] */
    conus_result *results;    /* [room] */
    size_t first, count, room;
    conus_status failure; /* of answering, with its message, since that belongs to a thread */
    char message[1024];
};

struct run {
    conus_pose_array poses;
    conus_many_options options; /* defaults filled in */
    struct batch_worker *workers;
    struct block *blocks;
    size_t block_count, next; /* pose to be read */
    conus_answer_sink sink;
    void *user;
    const struct block *last; /* delivered */
    bool cancelled;
};

static conus_status block_init(struct block *out, size_t capacity)
{
    *out = (struct block){.poses = memory_raw(capacity, sizeof *out->poses),
                          .starts = memory_zeroed(capacity + 1, sizeof *out->starts),
                          .statuses = memory_raw(capacity, sizeof *out->statuses)};
    return out->poses && out->starts && out->statuses ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void block_finish(struct block *block)
{
    memory_free(block->poses);
    memory_free(block->starts);
    memory_free(block->statuses);
    memory_free(block->results);
}

static conus_status pose_at(conus_pose *out, const conus_pose_array *poses, size_t i)
{
    return poses->matrix ? conus_pose_from_matrix(out, poses->matrix + 16 * i)
                         : conus_pose_along(out, poses->origin + 3 * i, poses->direction + 3 * i,
                                            poses->up ? poses->up + 3 * i : NULL);
}

static bool read_block(void *user, size_t slot)
{
    struct run *run = user;
    struct block *block = &run->blocks[slot];
    const conus_pose_array *poses = &run->poses;
    block->first = run->next;
    block->count = poses->count - run->next < run->options.block ? poses->count - run->next : run->options.block;
    for (size_t i = 0; i < block->count; i++) {
        size_t n = block->first + i;
        struct batch_pose *pose = &block->poses[i];
        *pose = (struct batch_pose){.angle = poses->angle ? poses->angle[n] : 0, .line = n};
        pose->is_no_pose = pose_at(&pose->pose, poses, n) != CONUS_OK;
    }
    run->next += block->count;
    return run->next < poses->count;
}

static conus_status keep_answer(void *user, size_t index, const conus_selection *selection)
{
    struct block *block = user;
    size_t start = block->starts[index], count = conus_selection_count(selection);
    block->statuses[index] = selection ? CONUS_OK : CONUS_ERROR_ARGUMENT;
    block->starts[index + 1] = start + count;
    if (count && !memory_reserve(&block->results, &block->room, start + count, sizeof *block->results)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        block->results[start + i] = *conus_selection_result(selection, i);
    }
    return CONUS_OK;
}

static void answer_block(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    struct run *run = user;
    struct block *block = &run->blocks[slot];
    block->failure = batch_worker_answer(&run->workers[worker], block->poses, block->count, stop, keep_answer, block);
    if (block->failure) {
        strncpy(block->message, conus_message(), sizeof block->message - 1);
    }
}

static bool deliver_block(void *user, size_t slot)
{
    struct run *run = user;
    const struct block *block = run->last = &run->blocks[slot];
    const conus_answers answers = {block->first, block->count, block->starts, block->results, block->statuses};
    run->cancelled = !block->failure && !run->sink(run->user, &answers);
    return !block->failure && !run->cancelled;
}

static conus_status check(const conus_pose_array *poses)
{
    bool is_whole =
        poses->matrix ? !poses->origin && !poses->direction && !poses->up : poses->origin && poses->direction;
    return is_whole || !poses->count ? CONUS_OK
                                     : fail(CONUS_ERROR_ARGUMENT, "poses: either matrix or both origin and direction");
}

static conus_status build(struct run *run, conus_selector *selector)
{
    const conus_many_options *options = &run->options;
    run->block_count = ring_slots(options->threads);
    run->workers = memory_zeroed(options->threads, sizeof *run->workers);
    run->blocks = memory_zeroed(run->block_count, sizeof *run->blocks);
    conus_status status = run->workers && run->blocks ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint32_t i = 0; i < options->threads && !status; i++) {
        status = batch_worker_init(&run->workers[i], selector, options->block, options->angle);
    }
    for (size_t i = 0; i < run->block_count && !status; i++) {
        status = block_init(&run->blocks[i], options->block);
    }
    return status;
}

static void finish(struct run *run)
{
    for (size_t i = 0; run->workers && i < run->options.threads; i++) {
        batch_worker_finish(&run->workers[i]);
    }
    for (size_t i = 0; run->blocks && i < run->block_count; i++) {
        block_finish(&run->blocks[i]);
    }
    memory_free(run->workers);
    memory_free(run->blocks);
}

static conus_status answer_all(struct run *run)
{
    const struct ring ring = {.user = run,
                              .workers = run->options.threads,
                              .slots = run->block_count,
                              .read = read_block,
                              .answer = answer_block,
                              .deliver = deliver_block};
    conus_status status = ring_run(&ring);
    if (status) {
        return status;
    }
    return run->cancelled       ? fail(CONUS_ERROR_CANCELLED, "the sink ended the run")
           : run->last->failure ? fail(run->last->failure, "%s", run->last->message)
                                : CONUS_OK;
}

static void sum_up(conus_astray *out, const struct run *run)
{
    *out = (conus_astray){0};
    for (uint32_t i = 0; i < run->options.threads; i++) {
        aims_merge(out, &run->workers[i].aims.found);
    }
}

conus_status conus_select_many(conus_astray *astray, conus_selector *selector, const conus_pose_array *poses,
                               const conus_many_options *options, conus_answer_sink sink, void *user)
{
    struct run run = {.poses = *options_of(conus_pose_array, poses),
                      .options = *options_of(conus_many_options, options),
                      .sink = sink,
                      .user = user};
    conus_status status = check(&run.poses);
    status = status ? status : batch_fill_in(&run.options.threads, &run.options.block, &run.options.angle, selector);
    if (status) {
        return status;
    }
    size_t blocks = (run.poses.count + run.options.block - 1) / run.options.block;
    run.options.threads = blocks < run.options.threads ? blocks ? (uint32_t)blocks : 1 : run.options.threads;
    status = build(&run, selector);
    status = status ? status : answer_all(&run);
    if (!status && astray) {
        sum_up(astray, &run);
    }
    finish(&run);
    return status;
}
