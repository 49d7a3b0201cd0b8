/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a batch: hands blocks of poses to the workers, and writes their answers in order. */
#include "selection/batch/batch.h"
#include "selection/batch/ring.h"
#include "selection/report/report_text.h"

#include "base/memory.h"
#include "base/options.h"

static conus_status fill_in(conus_batch_options *options, const conus_selector *selector)
{
    if (options->report.format == CONUS_FORMAT_TABLE || options->report.format == CONUS_FORMAT_JSON) {
        return fail(CONUS_ERROR_ARGUMENT, "format: tables for people and JSON hold all answers at once, no batch");
    }
    conus_status status = batch_fill_in(&options->threads, &options->block, &options->angle, selector);
    if (report_is_of_probe(options->report.format)) {
        options->threads = 1;
        options->block = BATCH_BLOCK_LIMIT;
    }
    return status;
}

static conus_status add_report(conus_report **out, const struct batch_worker *worker,
                               const conus_report_options *options)
{
    conus_status status = conus_report_create(out, worker->selector, options);
    if (!status) {
        (*out)->options.no_voxels = true;
    }
    return status;
}

static void finish_atlas(struct batch_atlas *atlas, size_t threads)
{
    for (size_t i = 0; atlas->reports && i < threads; i++) {
        conus_report_destroy(atlas->reports[i]);
    }
    for (size_t i = 0; atlas->workers && i < threads; i++) {
        batch_worker_finish(&atlas->workers[i]);
    }
    memory_free((void *)atlas->reports);
    memory_free(atlas->workers);
}

/* Another atlas, behind those that are there. */
static conus_status add_atlas(conus_batch *batch, conus_selector *selector, const conus_report_options *report)
{
    const conus_batch_options *options = &batch->options;
    struct batch_atlas atlas = {.workers = memory_zeroed(options->threads, sizeof *atlas.workers),
                                .reports = memory_zeroed(options->threads, sizeof(conus_report *))};
    void *atlases = batch->atlases;
    bool fits = memory_reserve(&atlases, &batch->atlas_capacity, batch->atlas_count + 1, sizeof *batch->atlases);
    bool has_axes = report->rows == CONUS_ROWS_SEGMENTS || report_is_of_probe(report->format);
    conus_status status = fits && atlas.workers && atlas.reports ? CONUS_OK : CONUS_ERROR_MEMORY;
    batch->atlases = atlases;
    status = status || !has_axes ? status : selector_prepare_axis(selector);
    for (uint32_t i = 0; i < options->threads && !status; i++) {
        status = batch_worker_init(&atlas.workers[i], selector, options->block, options->angle);
        status = status ? status : add_report(&atlas.reports[i], &atlas.workers[i], report);
    }
    for (uint32_t i = 0; i < options->threads && batch->atlas_count && !status; i++) {
        status = conus_report_join(batch->atlases[0].reports[i], atlas.reports[i]); /* all can, or the first cannot */
    }
    if (status) {
        finish_atlas(&atlas, options->threads);
    } else {
        batch->atlases[batch->atlas_count++] = atlas;
    }
    return status;
}

static conus_status build(conus_batch *batch, conus_selector *selector)
{
    const conus_batch_options *options = &batch->options;
    batch->block_count = ring_slots(options->threads);
    batch->blocks = memory_zeroed(batch->block_count, sizeof *batch->blocks);
    conus_status status = batch->blocks ? add_atlas(batch, selector, &options->report) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < batch->block_count && !status; i++) {
        status = batch_block_init(&batch->blocks[i], options->block);
    }
    if (!status) {
        report_write_header(&batch->header, batch->atlases[0].reports[0]);
        status = buffer_status(&batch->header);
    }
    return status;
}

conus_status conus_batch_create(conus_batch **out, conus_selector *selector, const conus_batch_options *options)
{
    conus_batch_options filled = *options_of(conus_batch_options, options);
    conus_status status = fill_in(&filled, selector);
    if (status) {
        return status;
    }
    conus_batch *batch = memory_zeroed(1, sizeof *batch);
    if (!batch) {
        return CONUS_ERROR_MEMORY;
    }
    batch->options = filled;
    if (filled.report.frame) { /* the caller's may end */
        batch->frame = *filled.report.frame;
        batch->options.report.frame = &batch->frame;
    }
    status = build(batch, selector);
    if (status) {
        conus_batch_destroy(batch);
        return status;
    }
    *out = batch;
    return CONUS_OK;
}

conus_status conus_batch_add(conus_batch *batch, conus_selector *selector, const char *atlas)
{
    conus_batch_options own = batch->options;
    conus_status status = batch_fill_in(&own.threads, &own.block, &own.angle, selector);
    if (!status && own.threads != batch->options.threads) {
        status = fail(CONUS_ERROR_ARGUMENT, "threads: %s answers on one, the batch has %u", selector->engine->name,
                      batch->options.threads);
    }
    own.report.atlas = atlas;
    return status ? status : add_atlas(batch, selector, &own.report);
}

void conus_batch_destroy(conus_batch *batch)
{
    if (!batch) {
        return;
    }
    for (size_t i = 0; i < batch->atlas_count; i++) {
        finish_atlas(&batch->atlases[i], batch->options.threads);
    }
    for (size_t i = 0; batch->blocks && i < batch->block_count; i++) {
        batch_block_finish(&batch->blocks[i]);
    }
    memory_free(batch->atlases);
    memory_free(batch->blocks);
    buffer_finish(&batch->header);
    memory_free(batch);
}

uint32_t conus_batch_threads(const conus_batch *batch)
{
    return batch ? batch->options.threads : 0;
}

conus_astray conus_batch_astray(const conus_batch *batch)
{
    return conus_batch_astray_at(batch, 0);
}

conus_astray conus_batch_astray_at(const conus_batch *batch, size_t index)
{
    conus_astray sum = {0};
    for (size_t i = 0; index < batch->atlas_count && i < batch->options.threads; i++) {
        aims_merge(&sum, &batch->atlases[index].workers[i].aims.found);
    }
    return sum;
}

const char *conus_batch_header(const conus_batch *batch)
{
    return batch && batch->header.data ? batch->header.data : "";
}

conus_status conus_batch_sidecar(const char **text, size_t *size, conus_batch *batch)
{
    return conus_report_sidecar(text, size, batch->atlases[0].reports[0]);
}

struct run {
    conus_batch *batch;
    conus_pose_stream *poses;
    uint64_t left; /* poses still to be read */
    conus_batch_sink sink;
    void *user;
    const struct batch_block *last; /* delivered */
    bool cancelled;
};

/* Whether the block is all that is in the stream, if it is a probe. */
static conus_status check_whole(const struct run *run, const struct batch_block *block)
{
    bool is_all = block->first == 0 && block->count < block->capacity && block->count < run->left;
    return is_all || !block->count || !report_is_of_probe(run->batch->options.report.format)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT,
                      "format: a probe is one whole, but these are contacts %llu to %llu, and there may be more",
                      (unsigned long long)block->first + 1, (unsigned long long)block->first + block->count);
}

static bool read_block(void *user, size_t slot)
{
    struct run *run = user;
    struct batch_block *block = &run->batch->blocks[slot];
    batch_block_read(block, run->poses, run->left);
    batch_block_set_status(block, check_whole(run, block));
    run->left -= block->count;
    return !block->status && block->count == block->capacity;
}

static void answer_block(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    conus_batch *batch = ((struct run *)user)->batch;
    batch_block_answer(&batch->blocks[slot], batch->atlases, batch->atlas_count, worker, stop);
}

static bool deliver_block(void *user, size_t slot)
{
    struct run *run = user;
    const struct batch_block *block = run->last = &run->batch->blocks[slot];
    const conus_batch_block answers = {.text = block->text.data ? block->text.data : "",
                                       .size = block->text.size,
                                       .poses = block->count,
                                       .errors = block->errors,
                                       .line = block->errors ? block->error_line : 0,
                                       .why = block->errors ? block->error : NULL};
    run->cancelled = !block->status && block->count && !run->sink(run->user, &answers);
    return !block->status && !run->cancelled;
}

static void stop_reading(void *user)
{
    conus_pose_stream_stop(((struct run *)user)->poses);
}

conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit, conus_batch_sink sink,
                             void *user)
{
    struct run run = {.batch = batch, .poses = poses, .left = limit, .sink = sink, .user = user};
    const struct ring ring = {.user = &run,
                              .workers = batch->options.threads,
                              .slots = batch->block_count,
                              .read = read_block,
                              .answer = answer_block,
                              .deliver = deliver_block,
                              .interrupt = stop_reading};
    conus_status status = ring_run(&ring);
    if (status) {
        return status;
    }
    return run.cancelled      ? fail(CONUS_ERROR_CANCELLED, "the sink ended the run")
           : run.last->status ? fail(run.last->status, "%s", run.last->message)
                              : CONUS_OK;
}
