/* SPDX-License-Identifier: BSD-3-Clause */
/* conus batch: answers many poses with several threads. */
#include "batch/batch_jobs.h"
#include "batch/batch_output.h"
#include "cli/commands.h"
#include "options/interrupt.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"

#include <string.h>

/* A run of it, with its own way of writing. */
struct run {
    struct work work;
    struct batch_file file;
    struct progress progress;
    uint64_t done, errors;
    int code; /* of the sink */
};

static int write_block(struct run *run, const conus_batch_block *block)
{
    return run->work.output ? batch_file_append(&run->file, block) : output_write(NULL, block->text, block->size);
}

static bool deliver(void *user, const conus_batch_block *block)
{
    struct run *run = user;
    run->code = write_block(run, block);
    if (run->code) {
        return false;
    }
    run->done += block->poses;
    run->errors += block->errors;
    work_keep_error(&run->work, block);
    progress_update(&run->progress, run->done, run->errors);
    return !interrupt_signal();
}

static int open_output(struct run *run)
{
    struct work *work = &run->work;
    const char *header_row = conus_batch_header(work->batch);
    if (!work->output) {
        return output_write(NULL, header_row, strlen(header_row));
    }
    int code = batch_output_open(&run->file, work);
    run->done = run->file.poses;
    run->errors = run->file.errors;
    return code;
}

static void start_progress(struct run *run)
{
    const struct work *work = &run->work;
    progress_start(&run->progress, (enum progress_kind)work->settings->progress, work->settings->common.quiet, "poses",
                   0);
    run->progress.before = run->done;
    if (progress_is_shown(&run->progress)) {
        uint64_t total = work->count;
        bool known = total != UINT64_MAX || conus_pose_stream_count(&total, work->poses) == CONUS_OK;
        run->progress.total = known ? total : 0;
    }
}

/* Of a run that came to its end. */
static void say_findings(struct run *run)
{
    if (!run->code && !interrupt_signal()) {
        work_say_errors(&run->work, run->done, run->errors);
        work_find_aims(&run->work);
        work_say_aims(&run->work);
    }
}

static int answer_all(struct run *run)
{
    struct work *work = &run->work;
    int code = work_pass_over(work, work->first + run->done);
    if (code) {
        return code;
    }
    start_progress(run);
    interrupt_catch(work->poses);
    conus_status status = conus_batch_run(work->batch, work->poses, work->count - run->done, deliver, run);
    interrupt_release();
    if (status == CONUS_ERROR_CANCELLED) { /* by deliver(), which left word in run->code or came of a signal */
        status = CONUS_OK;
    }
    if (!status && !run->progress.on_terminal) { /* where a program reads along, the progress has the last word */
        say_findings(run);
    }
    progress_finish(&run->progress, run->done, run->errors);
    if (status) {
        return print_status(status);
    }
    if (run->progress.on_terminal) {
        say_findings(run);
    }
    int signal = interrupt_signal();
    if (!run->done && !run->code && !signal && work->shard.count == 1) {
        settings_say_no_poses(work->settings->poses, &work->settings->common);
    }
    return run->code ? run->code : signal ? batch_output_interrupted(work, run->done, signal) : EXIT_DONE;
}

static int finish(struct run *run)
{
    int code = work_check_poses(&run->work);
    if (code) {
        batch_file_disown(&run->file);
        return code;
    }
    return batch_output_finish(&run->file, &run->work);
}

static int answer_batch(void *user, const struct batch_settings *settings, const struct arguments *arguments)
{
    (void)user;
    struct run run = {.file = {.rows = -1, .log = -1}};
    int code = work_init(&run.work, settings, arguments);
    code = code ? code : work_open(&run.work);
    code = code ? code : work_build(&run.work);
    code = code ? code : open_output(&run);
    if (!code && !run.file.is_finished) {
        code = answer_all(&run);
        code = code || !run.work.output ? code : finish(&run);
    } else if (!code) {
        work_say_errors(&run.work, run.done, run.errors);
    }
    batch_file_close(&run.file);
    work_finish(&run.work);
    return code ? code : run.errors ? EXIT_DIFFERENT : EXIT_DONE;
}

static int run_batch(const void *given, const struct arguments *arguments)
{
    const struct batch_settings *settings = given;
    return batch_jobs_answer(settings, arguments, answer_batch, NULL);
}

const struct command cmd_batch = {
    .name = "batch",
    .summary = "answer many poses: multithreaded, sharded, resumable",
    .operands = {"ATLAS"},
    .optional = true,
    .form = "--poses FILE",
    .description =
        "Answers every pose as conus query does, many at a time, in memory that does not grow with their\n"
        "number. The rows come in the order of the poses and are the same, byte for byte, for any number of\n"
        "threads or shards. A pose that has no answer gets a row of kind \"error\" that says why, and the\n"
        "exit code is 1 at the end.",
    .examples = "  conus batch aal.nii.gz --poses poses.tsv -o rows.tsv\n"
                "  conus batch aal.nii.gz --poses poses.tsv -o rows.tsv --resume\n"
                "  conus batch aal.nii.gz --poses poses.tsv --shard 0/4 -o rows.0.tsv\n"
                "  conus batch --jobs subjects.tsv --summary --resume\n",
    .see_also = "  conus merge     joins the outputs of --shard\n"
                "  conus verify    answers a result again, and compares\n",
    .family = commands,
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run_batch,
};
