/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses of arrays in, arrays of results out, by blocks. */
#include "selection/batch/batch.h"

#include "base/memory.h"
#include "base/options.h"
#include "base/status.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

struct block {
    struct batch_pose *poses; /* [capacity] */
    size_t *starts;           /* [capacity + 1] */
    conus_status *statuses;   /* [capacity] */
    conus_result *results;    /* [room] */
    size_t first, count, room;
};

struct run {
    conus_pose_array poses;
    conus_many_options options; /* defaults filled in */
    struct batch_worker *workers;
    struct block *blocks;
    size_t block_count, next; /* pose to be read */
    conus_answer_sink sink;
    void *user;
};

conus_status conus_pose_array_at(conus_pose *out, const conus_pose_array *poses, size_t index)
{
    const conus_pose_array given = *options_of(conus_pose_array, poses);
    if (given.matrix) {
        return pose_settle_in(out, given.matrix + 16 * index, given.frame);
    }
    conus_status status = conus_pose_along(out, given.origin + 3 * index, given.direction + 3 * index,
                                           given.up ? given.up + 3 * index : NULL);
    if (!status && given.frame) {
        conus_frame_turn_pose(out, given.frame, given.up != NULL);
    }
    return status;
}

static conus_status read_block(void *user, size_t slot, bool *may_follow)
{
    struct run *run = user;
    struct block *block = &run->blocks[slot];
    const conus_pose_array *poses = &run->poses;
    block->first = run->next;
    block->count = poses->count - run->next < run->options.block ? poses->count - run->next : run->options.block;
    for (size_t i = 0; i < block->count; i++) {
        size_t n = block->first + i;
        struct batch_pose *pose = &block->poses[i];
        *pose = (struct batch_pose){
            .angle = poses->angle ? poses->angle[n] : 0, .range = {NAN, NAN}, .radius = NAN, .line = n};
        if (poses->range) {
            memcpy(pose->range, poses->range + 2 * n, sizeof pose->range);
        }
        pose->is_point = !poses->matrix && !poses->direction;
        pose->is_no_pose = (pose->is_point ? pose_of_point(&pose->pose, poses->origin + 3 * n)
                                           : conus_pose_array_at(&pose->pose, poses, n)) != CONUS_OK;
    }
    run->next += block->count;
    *may_follow = run->next < poses->count;
    return CONUS_OK;
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

static conus_status answer_block(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    struct run *run = user;
    struct block *block = &run->blocks[slot];
    return batch_worker_answer(&run->workers[worker], block->poses, block->count, stop, keep_answer, block);
}

static conus_status deliver_block(void *user, size_t slot)
{
    struct run *run = user;
    const struct block *block = &run->blocks[slot];
    const conus_answers answers = {block->first, block->count, block->starts, block->results, block->statuses};
    return run->sink(run->user, &answers) ? CONUS_OK : fail(CONUS_ERROR_CANCELLED, "the sink ended the run");
}

static conus_status build(struct run *run, conus_selector *selector)
{
    const conus_many_options *options = &run->options;
    run->block_count = ring_slots(options->threads);
    run->workers = memory_zeroed(options->threads, sizeof *run->workers);
    run->blocks = memory_zeroed(run->block_count, sizeof *run->blocks);
    conus_status status = run->workers && run->blocks ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint32_t i = 0; i < options->threads && !status; i++) {
        status = batch_worker_init(&run->workers[i], selector, options->block, options->angle,
                                   (struct batch_points){.radius = options->radius});
    }
    for (size_t i = 0; i < run->block_count && !status; i++) {
        struct block *block = &run->blocks[i];
        block->poses = memory_raw(options->block, sizeof *block->poses);
        block->starts = memory_zeroed((size_t)options->block + 1, sizeof *block->starts);
        block->statuses = memory_raw(options->block, sizeof *block->statuses);
        status = block->poses && block->starts && block->statuses ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    return status;
}

static void finish(struct run *run)
{
    for (size_t i = 0; run->workers && i < run->options.threads; i++) {
        batch_worker_finish(&run->workers[i]);
    }
    for (size_t i = 0; run->blocks && i < run->block_count; i++) {
        memory_free(run->blocks[i].poses);
        memory_free(run->blocks[i].starts);
        memory_free(run->blocks[i].statuses);
        memory_free(run->blocks[i].results);
    }
    memory_free(run->workers);
    memory_free(run->blocks);
}

conus_status conus_select_many(conus_pose_findings *findings, conus_selector *selector, const conus_pose_array *poses,
                               const conus_many_options *options, conus_answer_sink sink, void *user)
{
    struct run run = {.poses = *options_of(conus_pose_array, poses),
                      .options = *options_of(conus_many_options, options),
                      .sink = sink,
                      .user = user};
    bool is_whole = run.poses.matrix ? !run.poses.origin && !run.poses.direction && !run.poses.up
                                     : run.poses.origin && (run.poses.direction || !run.poses.up);
    if (!is_whole && run.poses.count) {
        return fail(CONUS_ERROR_ARGUMENT, "poses: either matrix or origin, with direction or as points");
    }
    if (!(run.options.radius >= 0 && isfinite(run.options.radius))) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, allowed are 0 (what is at the point) and more",
                    run.options.radius);
    }
    const bool are_points = !run.poses.matrix && !run.poses.direction;
    conus_status status = batch_check_options(&run.options.threads, &run.options.block, &run.options.angle, selector);
    status = status ? status : weight_check_region(&selector->options, are_points);
    if (status) {
        return status;
    }
    size_t blocks = (run.poses.count + run.options.block - 1) / run.options.block;
    run.options.threads = blocks < run.options.threads ? blocks ? (uint32_t)blocks : 1 : run.options.threads;
    status = build(&run, selector);
    if (!status) {
        status = ring_run(&(const struct ring){.user = &run,
                                               .workers = run.options.threads,
                                               .slots = run.block_count,
                                               .read = read_block,
                                               .answer = answer_block,
                                               .deliver = deliver_block});
    }
    if (!status && findings) {
        *findings = (conus_pose_findings){0};
        for (uint32_t i = 0; i < run.options.threads; i++) {
            pose_check_merge(findings, &run.workers[i].aims.found);
        }
    }
    finish(&run);
    return status;
}
