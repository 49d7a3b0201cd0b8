/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/batch_file.h"
#include "cli/batch_jobs.h"
#include "cli/batch_work.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/output.h"
#include "cli/progress.h"

#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A run of it, with its own way of writing. */
struct run {
    struct work work;
    struct batch_file file;
    struct progress progress;
    uint64_t done, errors;
    int code; /* of the sink */
    bool was_complete;
};

static volatile sig_atomic_t signal_caught;

static void catch_signal(int number)
{
    signal_caught = number;
}

/* The first one ends the batch behind the block that is being delivered, the second one the program. One that is
 * ignored stays so. */
static void catch_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM};
    struct sigaction action = {.sa_handler = catch_signal, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct sigaction before;
        if (sigaction(numbers[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
            sigaction(numbers[i], &action, NULL);
        }
    }
}

/* ---- The rows --------------------------------------------------------------------------------------------------- */

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
    progress_update(&run->progress, run->done, run->errors);
    return !signal_caught;
}

static bool has_size(const char *path, uint64_t size)
{
    struct stat info;
    return stat(path, &info) == 0 && (uint64_t)info.st_size == size;
}

/* Whether an earlier run has written all of it; takes over its errors. */
static bool is_complete(struct run *run)
{
    const struct work *work = &run->work;
    struct batch_record record;
    if (batch_file_is_begun(work->output) || access(work->output, F_OK) || access(work->sidecar, F_OK) ||
        batch_record_read(&record, work->sidecar) || strcmp(record.fingerprint, work->fingerprint) != 0 ||
        record.shard.index != work->shard.index || record.shard.count != work->shard.count ||
        !has_size(work->output, record.bytes)) {
        return false;
    }
    run->errors = record.errors;
    return true;
}

static int open_file(struct run *run)
{
    const struct work *work = &run->work;
    char fingerprint[160];
    int code = batch_file_is_begun(work->output) ? EXIT_DONE : work_check_output(work);
    if (code) {
        return code;
    }
    snprintf(fingerprint, sizeof fingerprint, "%s %" PRIu64 "/%" PRIu64, work->fingerprint, work->shard.index,
             work->shard.count);
    code = batch_file_open(&run->file, work->output, fingerprint, conus_batch_heading(work->batch),
                           work->settings->force    ? BATCH_FORCE
                           : work->settings->resume ? BATCH_RESUME
                                                    : BATCH_ANEW);
    run->done = run->file.poses;
    run->errors = run->file.errors;
    return code;
}

static int open_output(struct run *run)
{
    struct work *work = &run->work;
    const char *heading = conus_batch_heading(work->batch);
    if (!work->output) {
        return output_write(NULL, heading, strlen(heading));
    }
    int code = work_identify(work);
    if (code) {
        return code;
    }
    run->was_complete = work->settings->resume && is_complete(run);
    return run->was_complete ? EXIT_DONE : open_file(run);
}

static int finish_output(struct run *run)
{
    if (!run->work.output) {
        return EXIT_DONE;
    }
    struct batch_record record = {
        .poses = run->done, .errors = run->errors, .bytes = run->file.size, .crc = run->file.crc};
    int code = work_write_sidecar(&run->work, &record);
    return code ? code : batch_file_finish(&run->file);
}

/* ---- The run ---------------------------------------------------------------------------------------------------- */

static void start_progress(struct run *run)
{
    const struct work *work = &run->work;
    progress_start(&run->progress, (enum progress_kind)work->settings->progress, work->settings->common.quiet);
    run->progress.before = run->done;
    if (progress_is_shown(&run->progress)) {
        uint64_t total = work->count;
        bool known = total != UINT64_MAX || conus_pose_stream_count(work->poses, &total) == CONUS_OK;
        run->progress.total = known ? total : 0;
    }
}

/* The command line that goes on with this batch; NULL without memory. */
static char *command_to_resume(const struct arguments *arguments)
{
    struct arguments changed = *arguments;
    char **words = calloc((size_t)arguments->count + 1, sizeof *words);
    char *text = NULL;
    changed.words = words;
    changed.count = 0;
    for (int i = 0; i < arguments->count && words; i++) {
        if (strcmp(arguments->words[i], "--force") != 0 && strcmp(arguments->words[i], "--resume") != 0) {
            words[changed.count++] = arguments->words[i];
        }
    }
    if (words) {
        static char resume[] = "--resume";
        words[changed.count++] = resume;
        text = arguments_text(&changed);
    }
    free(words);
    return text;
}

static int interrupted(const struct run *run)
{
    const struct work *work = &run->work;
    char *command =
        work->output && !output_is_stdout(work->settings->poses) ? command_to_resume(work->arguments) : NULL;
    complain("interrupted after %" PRIu64 " poses%s%s", run->done, command ? "; go on with: " : "",
             command ? command : "");
    free(command);
    return 128 + signal_caught;
}

static int answer_all(struct run *run)
{
    struct work *work = &run->work;
    int code = work_pass_over(work, work->first + run->done);
    if (code) {
        return code;
    }
    start_progress(run);
    catch_signals();
    conus_status status = conus_batch_run(work->batch, work->poses, work->count - run->done, deliver, run);
    progress_finish(&run->progress, run->done, run->errors);
    if (status) {
        return complain_status(status);
    }
    return run->code ? run->code : signal_caught ? interrupted(run) : EXIT_DONE;
}

static int answer(const struct batch_settings *settings, const struct arguments *arguments)
{
    struct run run = {.file = {.rows = -1, .log = -1}};
    int code = work_init(&run.work, settings, arguments);
    code = code ? code : work_prepare(&run.work);
    code = code ? code : open_output(&run);
    if (!code && !run.was_complete) {
        code = answer_all(&run);
        code = code ? code : finish_output(&run);
    }
    batch_file_close(&run.file);
    work_finish(&run.work);
    return code ? code : run.errors ? EXIT_DIFFERENT : EXIT_DONE;
}

/* ---- Many of them ------------------------------------------------------------------------------------------------ */

/* Of the exit codes of several batches the one that says most. */
static int worse(int a, int b)
{
    return a == EXIT_DONE || (a == EXIT_DIFFERENT && b != EXIT_DONE) ? b : a;
}

/* Answers the jobs that are this shard's, and goes on with the next one when one cannot be answered. */
static int answer_jobs(const struct batch_settings *settings, const struct arguments *arguments)
{
    struct batch_jobs jobs;
    struct shard shard;
    uint64_t first = 0;
    uint64_t count = 0;
    int code = batch_shard(&shard, settings);
    code = code ? code : batch_jobs_read(&jobs, settings->jobs);
    if (code) {
        return code;
    }
    shard_range(&first, &count, shard, jobs.count);
    for (uint64_t i = first; i < first + count && !signal_caught; i++) {
        struct batch_settings own = *settings;
        struct arguments aimed = *arguments;
        own.poses = jobs.jobs[i].poses;
        own.output = jobs.jobs[i].output;
        own.shard = "0/1";
        aimed.operands[0] = jobs.jobs[i].atlas;
        code = worse(code, answer(&own, &aimed));
    }
    batch_jobs_finish(&jobs);
    return code;
}

static bool check_operands(const struct batch_settings *settings, const struct arguments *arguments)
{
    if (settings->jobs) {
        return (!arguments->operand_count || (complain("ATLAS and --jobs exclude each other"), false)) &&
               options_exclude(arguments, "jobs", "poses") && options_exclude(arguments, "jobs", "output");
    }
    if (!arguments->operand_count) {
        complain("ATLAS is missing; conus batch --help shows how");
        return false;
    }
    return settings->poses || (complain("--poses FILE is missing"), false);
}

static int run(const void *given, const struct arguments *arguments)
{
    const struct batch_settings *settings = given;
    if (!check_operands(settings, arguments)) {
        return EXIT_USAGE;
    }
    return settings->jobs ? answer_jobs(settings, arguments) : answer(settings, arguments);
}

const struct command cmd_batch = {
    .name = "batch",
    .summary = "answer a file or stream of poses, on all processors, in parts, and again after a break",
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
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run,
};
