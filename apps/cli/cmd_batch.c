/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/batch_file.h"
#include "cli/batch_record.h"
#include "cli/commands.h"
#include "cli/messages.h"
#include "cli/output.h"
#include "cli/progress.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A batch under way. */
struct work {
    const struct batch_settings *settings;
    const struct arguments *arguments;
    const char *output; /* NULL = stdout */
    char *sidecar;
    char *command_line;
    conus_format format;
    struct shard shard;
    uint64_t first, count; /* poses to answer; count UINT64_MAX = all from there on */
    conus_pose_stream *poses;
    conus_atlas *atlas;
    conus_selector *selector;
    conus_batch *batch;
    char fingerprint[65], pose_hash[65];
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

static void work_finish(struct work *work)
{
    batch_file_close(&work->file);
    conus_batch_destroy(work->batch);
    conus_selector_destroy(work->selector);
    conus_atlas_destroy(work->atlas);
    conus_pose_stream_destroy(work->poses);
    free(work->sidecar);
    free(work->command_line);
}

static bool has_ending_of_ndjson(const char *path)
{
    return path && (path_ends(path, ".ndjson") || path_ends(path, ".jsonl"));
}

static bool check(const struct batch_settings *settings, const struct arguments *arguments)
{
    static const char *const of_output[] = {"force", "resume"};
    if (option_given(arguments, "slices") && settings->engine.sampling != CONUS_SLICES) {
        complain("--slices has no effect without --sampling slices");
        return false;
    }
    for (size_t i = 0; i < sizeof of_output / sizeof of_output[0]; i++) {
        if (!option_needs(arguments, of_output[i], "output")) {
            return false;
        }
    }
    return settings_check_score(&settings->engine, false) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) && settings_check_context(arguments) &&
           options_exclude(arguments, "force", "resume");
}

/* ---- The poses -------------------------------------------------------------------------------------------------- */

/* Which of them are this shard's. */
static int choose_poses(struct work *work)
{
    uint64_t total;
    work->count = UINT64_MAX;
    if (work->shard.count == 1) {
        return EXIT_DONE;
    }
    conus_status status = conus_pose_stream_count(work->poses, &total);
    if (status) {
        return complain_status(status);
    }
    shard_range(&work->first, &work->count, work->shard, total);
    return EXIT_DONE;
}

static int open_poses(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const conus_pose_options options = settings_pose_options(&settings->file, settings->aim.space);
    int code = batch_shard(&work->shard, settings);
    if (code) {
        return code;
    }
    if (output_is_stdout(settings->poses) && (work->shard.count > 1 || settings->resume)) {
        return complain_usage("%s needs a file of poses, not standard input",
                              settings->resume ? "--resume" : "--shard");
    }
    conus_status status = conus_pose_stream_open(&work->poses, settings->poses, &options);
    return status ? complain_status(status) : choose_poses(work);
}

static int pass_over(struct work *work, uint64_t poses)
{
    conus_status status = poses ? conus_pose_stream_skip(work->poses, poses) : CONUS_OK;
    return status ? complain_status(status) : EXIT_DONE;
}

/* ---- The rows --------------------------------------------------------------------------------------------------- */

static int write_block(struct work *work, const conus_batch_block *block)
{
    return work->output ? batch_file_append(&work->file, block) : output_write(NULL, block->text, block->size);
}

static bool deliver(void *user, const conus_batch_block *block)
{
    struct work *work = user;
    work->code = write_block(work, block);
    if (work->code) {
        return false;
    }
    work->done += block->poses;
    work->errors += block->errors;
    progress_update(&work->progress, work->done, work->errors);
    return !signal_caught;
}

/* Whether an earlier run has written all of it; takes over its errors. */
static bool is_complete(struct work *work)
{
    struct batch_record record;
    if (batch_file_is_begun(work->output) || access(work->output, F_OK) || access(work->sidecar, F_OK) ||
        batch_record_read(&record, work->sidecar) || strcmp(record.fingerprint, work->fingerprint) != 0 ||
        record.shard.index != work->shard.index || record.shard.count != work->shard.count) {
        return false;
    }
    work->errors = record.errors;
    return true;
}

static int open_output(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const char *heading = conus_batch_heading(work->batch);
    char fingerprint[160];
    if (!work->output) {
        return output_write(NULL, heading, strlen(heading));
    }
    int code = output_is_stdout(settings->poses) ? EXIT_DONE : batch_hash_file(work->pose_hash, settings->poses);
    code = code ? code : batch_fingerprint(work->fingerprint, work->batch, work->atlas, settings, work->pose_hash);
    if (code) {
        return code;
    }
    if (settings->resume && is_complete(work)) {
        work->was_complete = true;
        return EXIT_DONE;
    }
    if (!settings->force && !batch_file_is_begun(work->output) && access(work->output, F_OK) &&
        access(work->sidecar, F_OK) == 0) {
        return complain_usage("%s: there is a file already; --force replaces it", work->sidecar);
    }
    snprintf(fingerprint, sizeof fingerprint, "%s %" PRIu64 "/%" PRIu64, work->fingerprint, work->shard.index,
             work->shard.count);
    code = batch_file_open(&work->file, work->output, fingerprint, heading,
                           settings->force    ? BATCH_FORCE
                           : settings->resume ? BATCH_RESUME
                                              : BATCH_ANEW);
    work->done = work->file.poses;
    work->errors = work->file.errors;
    return code;
}

static int finish_output(struct work *work)
{
    const char *text = NULL;
    size_t size = 0;
    if (!work->output) {
        return EXIT_DONE;
    }
    double angle = settings_angle(&work->settings->aim, &work->settings->engine);
    struct batch_record record = {.shard = work->shard,
                                  .first = work->first,
                                  .poses = work->done,
                                  .errors = work->errors,
                                  .bytes = work->file.size,
                                  .crc = work->file.crc,
                                  .pose_file = work->settings->poses,
                                  .pose_hash = work->pose_hash,
                                  .angle = angle * (180 / M_PI)};
    memcpy(record.fingerprint, work->fingerprint, sizeof record.fingerprint);
    conus_status status = conus_batch_sidecar(work->batch, &text, &size);
    int code = status ? complain_status(status) : batch_record_write(work->sidecar, text, &record, work->command_line);
    return code ? code : batch_file_finish(&work->file);
}

/* ---- The run ---------------------------------------------------------------------------------------------------- */

static void start_progress(struct work *work)
{
    progress_start(&work->progress, (enum progress_kind)work->settings->progress, work->settings->common.quiet);
    work->progress.before = work->done;
    if (progress_is_shown(&work->progress)) {
        uint64_t total = work->count;
        bool known = total != UINT64_MAX || conus_pose_stream_count(work->poses, &total) == CONUS_OK;
        work->progress.total = known ? total : 0;
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

static int interrupted(const struct work *work)
{
    char *command =
        work->output && !output_is_stdout(work->settings->poses) ? command_to_resume(work->arguments) : NULL;
    complain("interrupted after %" PRIu64 " poses%s%s", work->done, command ? "; go on with: " : "",
             command ? command : "");
    free(command);
    return 128 + signal_caught;
}

static int answer_all(struct work *work)
{
    start_progress(work);
    catch_signals();
    conus_status status = conus_batch_run(work->batch, work->poses, work->count - work->done, deliver, work);
    progress_finish(&work->progress, work->done, work->errors);
    if (status) {
        return complain_status(status);
    }
    return work->code ? work->code : signal_caught ? interrupted(work) : EXIT_DONE;
}

static int load(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    int code = settings_load_atlas(&work->atlas, work->arguments->operands[0], &settings->atlas);
    code = code
               ? code
               : settings_load_context(work->atlas, settings->context.path, settings->context.blocks, &settings->atlas);
    if (code) {
        return code;
    }
    const struct input inputs[] = {{"the atlas", work->arguments->operands[0]},
                                   {"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->poses},
                                   {0}};
    const char *outputs[] = {work->output, work->sidecar};
    for (size_t i = 0; work->output && i < 2; i++) {
        const char *input = settings_input(work->atlas, inputs, outputs[i]);
        if (input) {
            return complain_usage("--output would overwrite %s %s", input, outputs[i]);
        }
    }
    return settings_match_stream(work->poses, settings->poses, work->atlas, &settings->file, &settings->common);
}

static int build(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const conus_selector_options engine = settings_engine(&settings->engine, &settings->common);
    const conus_batch_options options = {
        .threads = settings->threads,
        .block = settings->block,
        .angle = settings_angle(&settings->aim, &settings->engine),
        .report = {.format = work->format, .space = (conus_space)settings->aim.space},
    };
    conus_status status = conus_selector_create(&work->selector, work->atlas, &engine);
    status = status ? status : conus_batch_create(&work->batch, work->selector, &options);
    if (!status && settings->common.verbose) {
        complain("engine: %s; %" PRIu32 " threads", conus_selector_engine(work->selector),
                 conus_batch_threads(work->batch));
    }
    return status ? complain_status(status) : EXIT_DONE;
}

static int work_on(struct work *work)
{
    static int (*const steps[])(struct work *) = {open_poses, load, build, open_output};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        int code = steps[i](work);
        if (code) {
            return code;
        }
    }
    settings_say_notes(work->atlas, &work->settings->common);
    int code = EXIT_DONE;
    if (!work->was_complete) {
        code = pass_over(work, work->first + work->done);
        code = code ? code : answer_all(work);
        code = code ? code : finish_output(work);
    }
    return code ? code : work->errors ? EXIT_DIFFERENT : EXIT_DONE;
}

static int run(const void *given, const struct arguments *arguments)
{
    const struct batch_settings *settings = given;
    if (!check(settings, arguments)) {
        return EXIT_USAGE;
    }
    struct work work = {.settings = settings, .arguments = arguments, .file = {.rows = -1, .log = -1}};
    work.output = output_is_stdout(settings->output) ? NULL : settings->output;
    work.format = option_given(arguments, "format")   ? (settings->format ? CONUS_NDJSON : CONUS_TSV)
                  : has_ending_of_ndjson(work.output) ? CONUS_NDJSON
                                                      : CONUS_TSV;
    work.command_line = arguments_text(arguments);
    work.sidecar = work.output ? batch_sidecar_path(work.output) : NULL;
    int code = EXIT_DATA;
    if (!work.command_line || (work.output && !work.sidecar)) {
        complain("not enough memory");
    } else {
        code = work_on(&work);
    }
    work_finish(&work);
    return code;
}

const struct command cmd_batch = {
    .name = "batch",
    .summary = "answer a file or stream of poses, on all processors, in parts, and again after a break",
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
    .groups = batch_groups,
    .settings_size = sizeof(struct batch_settings),
    .more_help = help_scores,
    .run = run,
};
