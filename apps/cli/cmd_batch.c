/* SPDX-License-Identifier: BSD-3-Clause */
/* conus batch: answers many poses with several threads. */
#include "batch/batch_dispatch.h"
#include "batch/batch_task.h"
#include "cli/commands.h"
#include "options/interrupt.h"
#include "options/messages.h"

struct delivery {
    struct batch_task *task;
    int code; /* of writing */
};

static bool deliver(void *user, const conus_batch_block *block)
{
    struct delivery *delivery = user;
    struct batch_task *task = delivery->task;
    delivery->code = batch_file_append(&task->file, block);
    if (delivery->code) {
        return false;
    }
    batch_task_keep_error(task, block);
    progress_update(&task->progress, task->file.poses, task->file.errors);
    return !interrupt_signal();
}

static void say_findings(struct batch_task *task)
{
    batch_task_say_errors(task);
    batch_task_find_astray(task);
    batch_task_say_astray(task);
}

static int answer_poses(struct batch_task *task)
{
    struct delivery delivery = {.task = task};
    uint64_t answered = task->file.poses; /* by the run that this one resumes */
    int code = batch_task_skip(task, task->first + answered);
    if (code) {
        return code;
    }
    batch_task_start_progress(task);
    interrupt_catch(task->poses);
    conus_status status = conus_batch_run(task->batch, task->poses, task->count - answered, deliver, &delivery);
    interrupt_release();
    int signal = interrupt_signal();
    if (status == CONUS_ERROR_CANCELLED) { /* by deliver(), for its code or a signal */
        status = CONUS_OK;
    }
    bool is_whole = !status && !delivery.code && !signal;
    if (is_whole && !task->progress.on_terminal) { /* where a program reads along, the progress has the last word */
        say_findings(task);
    }
    progress_finish(&task->progress, task->file.poses, task->file.errors);
    if (status) {
        return print_status(status);
    }
    if (is_whole && task->progress.on_terminal) {
        say_findings(task);
    }
    if (is_whole && !task->file.poses && task->shard.count == 1) {
        pose_settings_say_none(task->settings->poses, &task->settings->common);
    }
    return delivery.code ? delivery.code : signal ? batch_task_interrupted(task, signal) : EXIT_DONE;
}

static int answer_batch(void *user, const struct batch_settings *settings, const struct arguments *arguments)
{
    (void)user;
    struct batch_task task;
    int code = batch_task_init(&task, settings, arguments);
    code = code ? code : batch_task_open(&task);
    code = code ? code : batch_task_build(&task);
    code = code ? code : batch_task_open_output(&task);
    if (!code && task.file.is_finished) {
        batch_task_say_errors(&task);
    } else if (!code) {
        code = answer_poses(&task);
        if (!code && task.output) {
            code = batch_task_check_poses(&task);
            if (code) {
                batch_file_disown(&task.file);
            }
            code = code ? code : batch_task_finish_output(&task);
        }
    }
    code = code || !task.file.errors ? code : EXIT_DIFFERENT;
    batch_task_finish(&task);
    return code;
}

static int run_batch(const void *given, const struct arguments *arguments)
{
    return batch_dispatch(given, arguments, answer_batch, NULL);
}

const struct command cmd_batch = {
    .name = "batch",
    .summary = "answer many poses: multithreaded, sharded, resumable",
    .operands = {"ATLAS"},
    .form = "--poses FILE",
    .description =
        "Answers every pose as conus query does, many at a time, in memory that does not grow with their\n"
        "number. The rows come in the order of the poses and are the same, byte for byte, for any number of\n"
        "threads or shards. A pose that has no answer gets a row of kind \"error\" that says why, and the\n"
        "exit code is 1 at the end.",
    .examples = "  conus batch aal.nii.gz --poses poses.tsv -o rows.tsv\n"
                "  conus batch aal.nii.gz --poses poses.tsv -o rows.tsv --resume\n"
                "  conus batch aal.nii.gz --poses poses.tsv --shard 0/4 -o rows.0.tsv\n",
    .see_also = "  conus merge     joins the outputs of --shard\n"
                "  conus verify    answers a result again, and compares\n",
    .answers = true,
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run_batch,
};
