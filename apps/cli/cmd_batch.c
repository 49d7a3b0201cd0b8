/* SPDX-License-Identifier: BSD-3-Clause */
/* conus batch: answers many poses with several threads. */
#include "batch/batch_jobs.h"
#include "batch/batch_run.h"
#include "cli/commands.h"
#include "options/interrupt.h"
#include "options/messages.h"

struct delivery {
    struct batch_run *run;
    int code; /* of writing */
};

static bool deliver(void *user, const conus_batch_block *block)
{
    struct delivery *delivery = user;
    struct batch_run *run = delivery->run;
    delivery->code = batch_file_append(&run->file, block);
    if (delivery->code) {
        return false;
    }
    batch_run_keep_error(run, block);
    progress_update(&run->progress, run->file.poses, run->file.errors);
    return !interrupt_signal();
}

static void say_findings(struct batch_run *run)
{
    batch_run_say_errors(run);
    batch_run_find_astray(run);
    batch_run_say_astray(run);
}

static int answer_poses(struct batch_run *run)
{
    struct delivery delivery = {.run = run};
    uint64_t answered = run->file.poses; /* by the run that this one resumes */
    int code = batch_run_skip(run, run->first + answered);
    if (code) {
        return code;
    }
    batch_run_start_progress(run);
    interrupt_catch(run->poses);
    conus_status status = conus_batch_run(run->batch, run->poses, run->count - answered, deliver, &delivery);
    interrupt_release();
    int signal = interrupt_signal();
    if (status == CONUS_ERROR_CANCELLED) { /* by deliver(), for its code or a signal */
        status = CONUS_OK;
    }
    bool is_whole = !status && !delivery.code && !signal;
    if (is_whole && !run->progress.on_terminal) { /* where a program reads along, the progress has the last word */
        say_findings(run);
    }
    progress_finish(&run->progress, run->file.poses, run->file.errors);
    if (status) {
        return print_status(status);
    }
    if (is_whole && run->progress.on_terminal) {
        say_findings(run);
    }
    if (is_whole && !run->file.poses && run->shard.count == 1) {
        settings_say_no_poses(run->settings->poses, &run->settings->common);
    }
    return delivery.code ? delivery.code : signal ? batch_run_interrupted(run, signal) : EXIT_DONE;
}

static int finish_output(struct batch_run *run)
{
    int code = batch_run_check_poses(run);
    if (code) {
        batch_file_disown(&run->file);
        return code;
    }
    return batch_run_finish_output(run);
}

static int answer_batch(void *user, const struct batch_settings *settings, const struct arguments *arguments)
{
    (void)user;
    struct batch_run run;
    int code = batch_run_init(&run, settings, arguments);
    code = code ? code : batch_run_open(&run);
    code = code ? code : batch_run_build(&run);
    code = code ? code : batch_run_open_output(&run);
    if (!code && run.file.is_finished) {
        batch_run_say_errors(&run);
    } else if (!code) {
        code = answer_poses(&run);
        code = code || !run.output ? code : finish_output(&run);
    }
    code = code || !run.file.errors ? code : EXIT_DIFFERENT;
    batch_run_finish(&run);
    return code;
}

static int run_batch(const void *given, const struct arguments *arguments)
{
    return batch_jobs_answer(given, arguments, answer_batch, NULL);
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
    .answers = true,
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run_batch,
};
