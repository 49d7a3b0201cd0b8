/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a batch: hands blocks of poses to the workers, and writes their answers in order. */
#include "selection/batch/batch.h"
#include "selection/report/report_text.h"

#include "base/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "selection/selection.h"
#include "selection/selector.h"

#include <sched.h>

enum { THREAD_LIMIT = 1024, BLOCK_LIMIT = 65536, DEFAULT_BLOCK = 256, DEFAULT_ANGLE_DEG = 10 };

/* Those that the process may use: a job's share of a cluster's node, say. */
static uint32_t count_processors(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return count < 1 ? 1 : count > THREAD_LIMIT ? THREAD_LIMIT : (uint32_t)count;
}

/* One string of all contacts. */
static bool is_of_probes(conus_format format)
{
    return format == CONUS_FORMAT_SPIKEGLX || format == CONUS_FORMAT_OPEN_EPHYS;
}

static conus_status fill_in(conus_batch_options *options, const conus_selector *selector)
{
    if (options->report.format == CONUS_FORMAT_TABLE || options->report.format == CONUS_FORMAT_JSON) {
        return fail(CONUS_ERROR_ARGUMENT, "format: tables for people and JSON hold all answers at once, no batch");
    }
    if (options->threads > THREAD_LIMIT || options->block > BLOCK_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %u, allowed is 1 to %d",
                    options->threads > THREAD_LIMIT ? "threads" : "block",
                    options->threads > THREAD_LIMIT ? options->threads : options->block,
                    options->threads > THREAD_LIMIT ? THREAD_LIMIT : BLOCK_LIMIT);
    }
    if (selector->ranking.info.needs_history) { /* each pose is answered on its own */
        return fail(CONUS_ERROR_ARGUMENT, "score: %s needs a history, which a batch has not",
                    selector->ranking.formula.text);
    }
    options->threads = options->threads ? options->threads : count_processors();
    options->threads = selector->options.engine == CONUS_ENGINE_GL ? 1 : options->threads;
    options->block = options->block ? options->block : DEFAULT_BLOCK;
    if (is_of_probes(options->report.format)) {
        options->threads = 1;
        options->block = BLOCK_LIMIT;
    }
    if (options->angle == 0 && selector->options.radius == 0) {
        options->angle = radians_from_degrees(DEFAULT_ANGLE_DEG);
    }
    return CONUS_OK;
}

static conus_status add_worker(conus_batch *batch, conus_selector *selector)
{
    struct batch_worker *worker = &batch->workers[batch->worker_count++];
    worker->angle = batch->options.angle;
    conus_status status = selector_share(&worker->selector, selector);
    status = status ? status : conus_report_create(&worker->report, worker->selector, &batch->options.report);
    worker->at_once = selections_at_once(selector);
    worker->at_once = worker->at_once < batch->options.block ? worker->at_once : batch->options.block;
    worker->begun = status ? NULL : memory_zeroed(worker->at_once, sizeof(conus_selection *));
    status = status || worker->begun ? status : CONUS_ERROR_MEMORY;
    if (!status) {
        worker->selector->inside_only = true;
        worker->aims = batch->aims;
        worker->aims.selector = worker->selector;
        worker->report->options.no_voxels = true;
    }
    return status;
}

static conus_status build(conus_batch *batch, conus_selector *selector)
{
    uint32_t threads = batch->options.threads;
    size_t blocks = threads == 1 ? 1 : 2 * (size_t)threads + 2;
    batch->workers = memory_zeroed(threads, sizeof *batch->workers);
    batch->blocks = memory_zeroed(blocks, sizeof *batch->blocks);
    conus_status status = batch->workers && batch->blocks ? CONUS_OK : CONUS_ERROR_MEMORY;
    aims_init(&batch->aims, selector);
    for (uint32_t i = 0; i < threads && !status; i++) {
        status = add_worker(batch, selector);
    }
    for (; batch->block_count < blocks && !status; batch->block_count++) {
        status = batch_block_init(&batch->blocks[batch->block_count], batch->options.block);
    }
    if (!status) {
        report_write_header(&batch->header, batch->workers[0].report);
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
    status = build(batch, selector);
    if (status) {
        conus_batch_destroy(batch);
        return status;
    }
    *out = batch;
    return CONUS_OK;
}

void conus_batch_destroy(conus_batch *batch)
{
    if (!batch) {
        return;
    }
    for (size_t i = 0; i < batch->worker_count; i++) {
        conus_report_destroy(batch->workers[i].report);
        conus_selector_destroy(batch->workers[i].selector);
        memory_free((void *)batch->workers[i].begun);
    }
    for (size_t i = 0; i < batch->block_count; i++) {
        batch_block_finish(&batch->blocks[i]);
    }
    memory_free(batch->workers);
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
    conus_astray sum = {0};
    for (size_t i = 0; i < batch->worker_count; i++) {
        aims_merge(&sum, &batch->workers[i].aims.found);
    }
    return sum;
}

const char *conus_batch_header(const conus_batch *batch)
{
    return batch && batch->header.data ? batch->header.data : "";
}

conus_status conus_batch_sidecar(const char **text, size_t *size, conus_batch *batch)
{
    return conus_report_sidecar(text, size, batch->workers[0].report);
}

bool batch_run_deliver(const struct batch_run *run, const struct batch_block *block)
{
    const conus_batch_block answers = {block->text.data ? block->text.data : "", block->text.size, block->count,
                                       block->errors};
    return !block->status && block->count && run->sink(run->user, &answers) && block->count == block->capacity;
}

/* Whether the block is all that is in the stream, if it is a probe. */
static conus_status check_whole(const struct batch_run *run, const struct batch_block *block)
{
    bool is_all = block->first == 0 && block->count < block->capacity && block->count < run->left;
    return is_all || !block->count || !is_of_probes(run->batch->options.report.format)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT,
                      "format: a probe is one whole, but these are contacts %llu to %llu, and there may be more",
                      (unsigned long long)block->first + 1, (unsigned long long)block->first + block->count);
}

static conus_status run_alone(struct batch_run *run)
{
    static const atomic_bool never = false;
    struct batch_block *block = &run->batch->blocks[0];
    do {
        batch_block_read(block, run->poses, run->left);
        conus_status status = check_whole(run, block);
        if (status) {
            return status;
        }
        batch_block_answer(block, &run->batch->workers[0], &never);
        run->left -= block->count;
    } while (batch_run_deliver(run, block));
    return block->status ? fail(block->status, "%s", block->message) : CONUS_OK;
}

conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit, conus_batch_sink sink,
                             void *user)
{
    struct batch_run run = {.batch = batch, .poses = poses, .left = limit, .sink = sink, .user = user};
    return batch->worker_count == 1 ? run_alone(&run) : batch_run_threads(&run);
}
