/* SPDX-License-Identifier: BSD-3-Clause */
/* A block of poses: read from a stream, and answered by a worker. */
#include "base/memory.h"
#include "poses/pose_stream.h"
#include "selection/batch/batch.h"
#include "selection/rank.h"
#include "selection/report/report_text.h"
#include "selection/selection.h"
#include "selection/selector.h"

#include <stdio.h>
#include <string.h>

enum { ROWS_AT_ONCE = 64 };

conus_status batch_block_init(struct batch_block *out, size_t capacity)
{
    *out = (struct batch_block){.poses = memory_raw(capacity, sizeof *out->poses), .capacity = capacity};
    return out->poses ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void batch_block_finish(struct batch_block *block)
{
    memory_free(block->poses);
    buffer_finish(&block->strings);
    buffer_finish(&block->text);
}

static void set_status(struct batch_block *block, conus_status status)
{
    block->status = status;
    if (status) {
        snprintf(block->message, sizeof block->message, "%s", conus_message());
    }
}

static size_t keep_string(struct batch_block *block, const char *string)
{
    size_t at = block->strings.size;
    buffer_append(&block->strings, string, strlen(string) + 1);
    return at;
}

static void keep_row(struct batch_block *block, const conus_pose_row *row)
{
    struct batch_pose *pose = &block->poses[block->count++];
    *pose = (struct batch_pose){.line = row->line, .is_no_pose = row->error != NULL, .is_point = row->is_point};
    pose->id = keep_string(block, row->id);
    if (row->error) {
        pose->error = keep_string(block, row->error);
    } else {
        pose->pose = row->pose;
        pose->angle = row->angle;
    }
}

static conus_status read_rows(struct batch_block *block, conus_pose_stream *poses, size_t wanted)
{
    conus_pose_row rows[ROWS_AT_ONCE];
    while (block->count < wanted) {
        size_t missing = wanted - block->count;
        size_t count = 0;
        conus_status status =
            conus_pose_stream_read(rows, &count, poses, missing < ROWS_AT_ONCE ? missing : ROWS_AT_ONCE);
        if (status || count == 0) {
            return status;
        }
        for (size_t i = 0; i < count; i++) {
            keep_row(block, &rows[i]);
        }
    }
    return buffer_status(&block->strings);
}

void batch_block_read(struct batch_block *block, conus_pose_stream *poses, uint64_t limit)
{
    block->count = 0;
    block->errors = 0;
    block->first = pose_stream_position(poses);
    block->is_done = false;
    buffer_clear(&block->strings);
    buffer_clear(&block->text);
    set_status(block, read_rows(block, poses, limit < block->capacity ? (size_t)limit : block->capacity));
}

static conus_status add_error(struct batch_block *block, conus_report *report, const struct batch_pose *pose,
                              const char *reason)
{
    block->errors++;
    return conus_report_add_error(report, block->strings.data + pose->id, pose->line, reason);
}

static double angle_of(const struct batch_worker *worker, const struct batch_pose *pose)
{
    return pose->angle != 0 ? pose->angle : worker->angle;
}

/* A point is asked what is within the cylinders' radius of it. */
static conus_status begin_selection(conus_selection **out, struct batch_worker *worker, const struct batch_pose *pose)
{
    double radius = worker->selector->options.radius;
    if (!pose->is_point) {
        return conus_select(out, worker->selector, &pose->pose, angle_of(worker, pose));
    }
    return radius > 0 ? conus_select_ball(out, worker->selector, pose->pose.world_from_device + 12, radius)
                      : fail(CONUS_ERROR_ARGUMENT, "a point, without the direction that a cone needs");
}

static conus_status answer_pose(struct batch_block *block, struct batch_worker *worker, const struct batch_pose *pose)
{
    conus_selection *selection = NULL;
    if (pose->is_no_pose) {
        return add_error(block, worker->report, pose, block->strings.data + pose->error);
    }
    conus_status status = begin_selection(&selection, worker, pose);
    if (status == CONUS_ERROR_ARGUMENT) { /* the pose's own fault */
        return add_error(block, worker->report, pose, conus_message());
    }
    status = status ? status : conus_report_add(worker->report, block->strings.data + pose->id, selection);
    conus_selection_destroy(selection);
    return status;
}

/* Begins the selections of the poses and traces all of them. Those that have none are left to answer_pose(), which says
 * why. */
static conus_status begin_and_trace(struct batch_worker *worker, const struct batch_pose *poses, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        if (!poses[i].is_no_pose && !poses[i].is_point) {
            status = selection_begin(&worker->begun[i], worker->selector, &poses[i].pose, angle_of(worker, &poses[i]));
            status = status == CONUS_ERROR_ARGUMENT ? CONUS_OK : status;
        }
    }
    return status ? status : selections_trace(worker->begun, count, worker->selector);
}

/* answer_pose() for poses number `first` to first + count - 1, of which at_once may be given. */
static conus_status answer_together(struct batch_block *block, struct batch_worker *worker, size_t first, size_t count)
{
    const struct batch_pose *poses = block->poses + first;
    conus_status status = begin_and_trace(worker, poses, count);
    for (size_t i = 0; i < count; i++) {
        conus_selection *selection = worker->begun[i];
        if (selection && !status) {
            status = selection_complete(selection, worker->selector);
        }
        if (selection && !status) {
            selection_rank(selection, worker->selector, NULL);
            status = conus_report_add(worker->report, block->strings.data + poses[i].id, selection);
        } else if (!status) {
            status = answer_pose(block, worker, &poses[i]);
        }
        conus_selection_destroy(selection);
        worker->begun[i] = NULL;
    }
    return status;
}

static void count_aims(struct batch_worker *worker, const struct batch_pose *poses, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!poses[i].is_no_pose && !poses[i].is_point) {
            conus_aims_add(&worker->aims, poses[i].line, &poses[i].pose, angle_of(worker, &poses[i]));
        }
    }
}

void batch_block_answer(struct batch_block *block, struct batch_worker *worker, const atomic_bool *stop)
{
    conus_status status = block->status;
    for (size_t i = 0, count; i < block->count && !status && !atomic_load_explicit(stop, memory_order_relaxed);
         i += count) {
        count = block->count - i < worker->at_once ? block->count - i : worker->at_once;
        status = count == 1 ? answer_pose(block, worker, &block->poses[i]) : answer_together(block, worker, i, count);
    }
    if (!status) {
        count_aims(worker, block->poses, block->count);
        worker->report->taken = (size_t)block->first;
        status = report_write_part(&block->text, worker->report);
        status = status ? status : buffer_status(&block->text);
    }
    report_clear(worker->report);
    if (!block->status) {
        set_status(block, status);
    }
}
