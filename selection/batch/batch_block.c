/* SPDX-License-Identifier: BSD-3-Clause */
/* A block of poses: read from a stream, and answered as rows of text. */
#include "base/memory.h"
#include "poses/pose_stream.h"
#include "selection/batch/batch.h"
#include "selection/report/report_text.h"

#include <stdio.h>
#include <string.h>

enum { ROWS_AT_ONCE = 64 };

conus_status batch_block_init(struct batch_block *out, size_t capacity)
{
    *out = (struct batch_block){.poses = memory_raw(capacity, sizeof *out->poses),
                                .words = memory_raw(capacity, sizeof *out->words),
                                .capacity = capacity};
    return out->poses && out->words ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void batch_block_finish(struct batch_block *block)
{
    memory_free(block->poses);
    memory_free(block->words);
    buffer_finish(&block->strings);
    buffer_finish(&block->text);
}

void batch_block_set_status(struct batch_block *block, conus_status status)
{
    if (status && !block->status) {
        block->status = status;
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
    struct batch_pose *pose = &block->poses[block->count];
    struct batch_words *words = &block->words[block->count++];
    *pose = (struct batch_pose){.line = row->line, .is_no_pose = row->error != NULL, .is_point = row->is_point};
    words->id = keep_string(block, row->id);
    if (row->error) {
        words->error = keep_string(block, row->error);
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
    block->status = CONUS_OK;
    buffer_clear(&block->strings);
    buffer_clear(&block->text);
    batch_block_set_status(block, read_rows(block, poses, limit < block->capacity ? (size_t)limit : block->capacity));
}

struct writing {
    struct batch_block *block;
    conus_report *report;
    bool counts; /* a pose without an answer is one error, however many atlases have none */
};

static const char *id_of(const struct writing *writing, size_t index)
{
    return writing->block->strings.data + writing->block->words[index].id;
}

static conus_status add_error(const struct writing *writing, size_t index)
{
    struct batch_block *block = writing->block;
    const struct batch_pose *pose = &block->poses[index];
    const char *why = pose->is_no_pose ? block->strings.data + block->words[index].error : conus_message();
    bool is_first = writing->counts && !block->errors;
    block->errors += writing->counts;
    if (is_first) {
        block->error_line = pose->line;
        snprintf(block->error, sizeof block->error, "%s", why);
    }
    return conus_report_add_error(writing->report, id_of(writing, index), pose->line, why);
}

static conus_status add_to_report(void *user, size_t index, const conus_selection *selection)
{
    const struct writing *writing = user;
    return selection ? conus_report_add(writing->report, id_of(writing, index), selection) : add_error(writing, index);
}

static conus_status add_axis_to_report(void *user, size_t index, const conus_segments *segments)
{
    const struct writing *writing = user;
    return segments ? conus_report_add_segments(writing->report, id_of(writing, index), segments)
                    : add_error(writing, index);
}

/* Whether axes are asked about: of a probe, where its poses have one. */
static conus_status find_axes(bool *out, const struct batch_block *block, const conus_report *report)
{
    size_t with[2] = {0};
    for (size_t i = 0; i < block->count && report_is_of_probe(report->options.format); i++) {
        with[block->poses[i].is_point] += !block->poses[i].is_no_pose;
    }
    if (with[0] && with[1]) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "format: of the poses %zu have a direction, as shanks do, and %zu are contacts", with[0], with[1]);
    }
    *out = with[0] || report->options.rows == CONUS_ROWS_SEGMENTS;
    return CONUS_OK;
}

void batch_block_answer(struct batch_block *block, const struct batch_atlas *atlases, size_t atlas_count, size_t worker,
                        const atomic_bool *stop)
{
    conus_report *first = atlases[0].reports[worker];
    bool of_axes = false;
    batch_block_set_status(block, block->status ? block->status : find_axes(&of_axes, block, first));
    for (size_t i = 0; i < atlas_count && !block->status; i++) {
        struct writing writing = {block, atlases[i].reports[worker], i == 0};
        struct batch_worker *asked = &atlases[i].workers[worker];
        batch_block_set_status(
            block, of_axes ? batch_worker_follow(asked, block->poses, block->count, stop, add_axis_to_report, &writing)
                           : batch_worker_answer(asked, block->poses, block->count, stop, add_to_report, &writing));
    }
    if (!block->status) {
        first->taken = (size_t)block->first;
        conus_status status = report_write_part(&block->text, first);
        batch_block_set_status(block, status ? status : buffer_status(&block->text));
    }
    for (size_t i = 0; i < atlas_count; i++) {
        report_clear(atlases[i].reports[worker]);
    }
}
