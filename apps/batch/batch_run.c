/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of a batch that conus batch and conus-mpi share: checks, inputs, the library's batch, output. */
#include "batch/batch_run.h"

#include "options/messages.h"
#include "options/output.h"
#include "options/outputs.h"
#include "options/provenance.h"
#include "settings/notes.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool check_settings(conus_format *format, const struct batch_settings *settings,
                           const struct arguments *arguments)
{
    if (!batch_format(format, settings, arguments)) {
        return false;
    }
    if (settings->atlas.more.count && format_is_foreign(*format)) {
        print_error_line(
            "--format: formats of other programs have no column for the atlas; tsv, csv and ndjson have one");
        return false;
    }
    if (settings->of_axis && format_is_foreign(*format)) {
        print_error_line("--format: formats of other programs hold no %s; tsv, csv and ndjson do",
                         settings->of_axis->option);
        return false;
    }
    if (settings->of_axis && !option_given(arguments, "output") && (settings->summary || settings->axis.order)) {
        print_error_line("--%s has no effect without --output: other rows have but one order",
                         settings->summary ? "summary" : "order");
        return false;
    }
    if (settings->summary && format_is_foreign(*format)) {
        print_error_line("--summary: formats of other programs have no summary; tsv, csv and ndjson have one");
        return false;
    }
    if ((settings->force || settings->resume) && output_is_stdout(settings->output)) {
        print_error_line("--%s has no effect without a file for --output", settings->force ? "force" : "resume");
        return false;
    }
    return settings_check_score(&settings->engine, false) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) &&
           settings_check_space(arguments, &settings->aim.space);
}

int batch_run_init(struct batch_run *out, const struct batch_settings *settings, const struct arguments *arguments)
{
    *out = (struct batch_run){.settings = settings, .arguments = arguments, .file = {.rows = -1, .log = -1}};
    if (!check_settings(&out->format, settings, arguments)) {
        return EXIT_USAGE;
    }
    int code = settings_contacts(&out->contacts, settings->axis.contacts);
    code = code ? code : settings_within(&out->within, arguments);
    if (code) {
        return code;
    }
    out->output = output_is_stdout(settings->output) ? NULL : settings->output;
    out->command_line = arguments_text(arguments);
    out->sidecar = out->output ? provenance_path(out->output) : NULL;
    if (!out->command_line || (out->output && !out->sidecar)) {
        return print_no_memory();
    }
    code = out->output ? output_check_file(out->output) : EXIT_DONE;
    code = code || !out->sidecar ? code : output_check_file(out->sidecar);
    for (int i = 1; out->output && i < arguments->count && !code; i++) {
        code = outputs_check_name(arguments->words[i]);
    }
    return code ? code : atlases_name(&out->atlases, arguments->operands[0], &settings->atlas);
}

/* Opens the poses, and finds which of them are the shard's. */
static int open_poses(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    const conus_pose_options options = settings_pose_options(&settings->file, &run->frame, settings->atlas.max_memory);
    int code = batch_shard(&run->shard, settings);
    if (code) {
        return code;
    }
    if (run->shard.count > 1 && format_is_of_probe(run->format)) {
        return print_usage_error("--shard: a probe's string is one whole; --jobs answers many probes");
    }
    run->piped = output_is_no_file(settings->poses);
    if (run->piped && (run->shard.count > 1 || settings->resume)) {
        return print_usage_error("%s needs a file of poses, not %s", settings->resume ? "--resume" : "--shard",
                                 output_is_stdout(settings->poses) ? "standard input" : "a pipe");
    }
    conus_status status = conus_pose_stream_open(&run->poses, settings->poses, &options);
    if (status) {
        return settings_print_poses_error(status, settings->poses, "poses", run->arguments);
    }
    code = settings_check_electrodes(run->format, conus_pose_stream_electrodes(run->poses), settings->poses);
    if (code) {
        return code;
    }
    run->count = UINT64_MAX;
    if (run->shard.count > 1) {
        uint64_t total;
        status = conus_pose_stream_count(&total, run->poses);
        if (status) {
            return print_status(status);
        }
        shard_range(&run->first, &run->count, run->shard, total);
    }
    return EXIT_DONE;
}

/* No file that is written, partial file and journal included, may be one that is read. */
static int check_files(const struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    const struct {
        const char *path, *ending;
    } written[] = {{run->sidecar, ""}, {run->output, ""}, {run->output, ".part"}, {run->output, ".journal"}};
    const struct input inputs[] = {{"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->poses},
                                   {"the coordinate system", conus_pose_stream_coordsystem(run->poses)},
                                   {"the table of batches", settings->jobs},
                                   {0}};
    const char *option = settings->of_axis ? settings->of_axis->option : "output";
    if (!run->output) {
        return EXIT_DONE;
    }
    int code = outputs_check_name(run->output); /* of a table of batches, too */
    code = code ? code : outputs_check_name(settings->poses);
    code = code ? code : atlases_check_names(&run->atlases);
    for (size_t i = 0; !code && i < sizeof written / sizeof written[0]; i++) {
        char *path = NULL;
        if (asprintf(&path, "%s%s", written[i].path, written[i].ending) < 0) {
            return print_no_memory();
        }
        const char *input = atlases_input(&run->atlases, inputs, path);
        code = input ? print_usage_error("--%s would overwrite %s %s", option, input, path) : EXIT_DONE;
        free(path);
    }
    return code ? code : outputs_check_sidecar(run->sidecar);
}

/* Loads those that are not there yet, with their context. */
static int load_atlases(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    struct atlases *atlases = &run->atlases;
    int code = EXIT_DONE;
    for (size_t i = 0; i < atlases->count && !code; i++) {
        if (!atlases->items[i].atlas) {
            code = atlases_load_at(atlases, i, &settings->atlas);
            code = code ? code
                        : settings_load_context(atlases->items[i].atlas, settings->context.path,
                                                settings->context.blocks, &settings->atlas);
        }
    }
    return code;
}

int batch_run_open(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    bool late = settings_space_needs_atlas(&settings->aim.space);
    int code = late ? load_atlases(run) : EXIT_DONE;
    code = code ? code : settings_frame(&run->frame, &run->atlases, &settings->aim.space, settings->common.quiet);
    code = code ? code : open_poses(run);
    code = code || late ? code : load_atlases(run);
    code = code ? code : check_files(run);
    return code ? code
                : settings_match_stream(run->poses, settings->poses, &run->atlases, &settings->file, &settings->common);
}

int batch_run_build(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    conus_selector_options engine = settings_engine(&settings->engine, &settings->common);
    const conus_batch_options options = {
        .threads = settings->threads,
        .block = settings->block,
        .angle = settings_angle(&settings->aim, &settings->engine),
        .report = {.rows = settings->of_axis   ? settings->of_axis->rows
                           : settings->summary ? CONUS_ROWS_SUMMARIES
                                               : CONUS_ROWS_ANSWERS,
                   .format = run->format,
                   .frame = &run->frame,
                   .electrodes = run->format == CONUS_FORMAT_BIDS ? conus_pose_stream_electrodes(run->poses) : NULL,
                   .atlas = run->atlases.items[0].name,
                   .order = settings->of_axis ? CONUS_ORDER_RANK : (conus_order)settings->axis.order,
                   .contacts = settings->of_axis ? (conus_contacts){0} : run->contacts,
                   .within = run->within},
    };
    run->aimed = calloc(run->atlases.count, sizeof *run->aimed);
    if (!run->aimed) {
        return print_no_memory();
    }
    for (size_t i = 0; i < run->atlases.count; i++) {
        const struct named_atlas *item = &run->atlases.items[i];
        struct aimed *aimed = &run->aimed[i];
        *aimed = (struct aimed){.atlas = item->atlas, .name = item->name, .frame = &run->frame};
        engine.level = i ? NULL : engine.level;
        conus_status status = conus_selector_create(&aimed->selector, item->atlas, &engine);
        status = status   ? status
                 : i == 0 ? conus_batch_create(&run->batch, aimed->selector, &options)
                          : conus_batch_add(run->batch, aimed->selector, item->name);
        if (status) {
            return print_status(status);
        }
    }
    if (settings->common.verbose) {
        print_error_line("engine: %s; %" PRIu32 " threads", conus_selector_engine(run->aimed[0].selector),
                         conus_batch_threads(run->batch));
    }
    atlases_say_notes(&run->atlases, &settings->common);
    atlases_say_spaces(&run->atlases, &settings->common);
    atlases_say_open(&run->atlases, &settings->engine, &settings->common);
    return EXIT_DONE;
}

/* Hashes the poses, and all that the rows depend on. */
static int identify(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    const conus_atlas *atlas = run->atlases.items[0].atlas;
    const char *asked = run->arguments->operands[0];
    const char format[] = {(char)('0' + run->format), '\0'};
    /* AFNI's rows have the name of the atlas's file without its folder, or that of its manifest. */
    bool has_file_name = run->format == CONUS_FORMAT_AFNI;
    const conus_volume_info *info = has_file_name ? conus_atlas_volume(atlas, 0) : NULL;
    const char *first = has_file_name ? conus_atlas_file(atlas, 0) : NULL;
    const char *sidecar = NULL;
    size_t size = 0;
    char angle[32], reading[64];
    snprintf(angle, sizeof angle, "%.17g", settings->aim.angle);
    settings_pose_text(reading, &settings->file);
    conus_status status = conus_batch_sidecar(&sidecar, &size, run->batch);
    const char *const sources[] = {angle,
                                   reading,
                                   conus_batch_header(run->batch),
                                   run->pose_hash,
                                   conus_pose_stream_space(run->poses),
                                   conus_pose_stream_coordsystem_sha256(run->poses),
                                   format,
                                   info ? path_name(info->path) : "",
                                   first && strcmp(first, asked) == 0 ? path_name(asked) : NULL,
                                   NULL};
    int code = status       ? print_status(status)
               : run->piped ? EXIT_DONE
                            : provenance_hash_file(run->pose_hash, settings->poses);
    return code ? code : batch_fingerprint(run->fingerprint, sidecar, &run->atlases, sources);
}

/* Whether an earlier run has written all of it; takes over what that run counted. */
static bool is_complete(struct batch_run *run)
{
    struct batch_record record;
    struct stat info;
    if (batch_file_is_begun(run->output) || access(run->output, F_OK) || access(run->sidecar, F_OK) ||
        batch_record_read(&record, run->sidecar) || strcmp(record.fingerprint, run->fingerprint) != 0 ||
        record.shard.index != run->shard.index || record.shard.count != run->shard.count || stat(run->output, &info) ||
        (uint64_t)info.st_size != record.bytes) {
        return false;
    }
    run->file.poses = record.poses;
    run->file.errors = record.errors;
    run->file.is_finished = true;
    return true;
}

int batch_run_open_output(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    char fingerprint[160];
    if (!run->output) {
        const char *header_row = conus_batch_header(run->batch);
        return output_write(NULL, header_row, strlen(header_row));
    }
    int code = identify(run);
    if (code || (settings->resume && is_complete(run))) {
        return code;
    }
    const char *there = access(run->output, F_OK) == 0 ? run->output : run->sidecar;
    if (!batch_file_is_begun(run->output) && !settings->force && access(there, F_OK) == 0) {
        return print_usage_error("%s: there is a file already; --force replaces it", there);
    }
    snprintf(fingerprint, sizeof fingerprint, "%s %" PRIu64 "/%" PRIu64, run->fingerprint, run->shard.index,
             run->shard.count);
    return batch_file_open(&run->file, run->output, fingerprint, conus_batch_header(run->batch),
                           settings->force    ? BATCH_FORCE
                           : settings->resume ? BATCH_RESUME
                                              : BATCH_ANEW);
}

int batch_run_skip(struct batch_run *run, uint64_t poses)
{
    conus_status status = poses ? conus_pose_stream_skip(run->poses, poses) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
}

void batch_run_start_progress(struct batch_run *run)
{
    const struct batch_settings *settings = run->settings;
    progress_start(&run->progress, (enum progress_kind)settings->progress, settings->common.quiet, "poses", 0);
    run->progress.before = run->file.poses;
    if (progress_is_shown(&run->progress)) {
        uint64_t total = run->count;
        bool known = total != UINT64_MAX || conus_pose_stream_count(&total, run->poses) == CONUS_OK;
        run->progress.total = known ? total : 0;
    }
}

void batch_run_keep_error(struct batch_run *run, const conus_batch_block *block)
{
    struct first_error *first = &run->first_error;
    if (block->errors && !first->line) {
        first->line = block->line;
        snprintf(first->why, sizeof first->why, "%s", block->why);
    }
}

void batch_run_say_errors(const struct batch_run *run)
{
    const struct first_error *first = &run->first_error;
    char where[sizeof first->why + 64] = "";
    if (first->line) {
        snprintf(where, sizeof where, ", the first in line %" PRIu64 ": %s", first->line, first->why);
    }
    if (run->file.errors && !run->settings->is_again) {
        print_error_line("%s: no answer to %" PRIu64 " of %" PRIu64 " poses%s",
                         settings_poses_name(run->settings->poses), run->file.errors, run->file.poses, where);
    }
}

void batch_run_find_astray(struct batch_run *run)
{
    for (size_t i = 0; i < run->atlases.count; i++) {
        run->aimed[i].found = conus_batch_astray_at(run->batch, i);
    }
}

void batch_run_say_astray(const struct batch_run *run)
{
    aim_notes_say(run->aimed, run->atlases.count, settings_poses_name(run->settings->poses), &run->settings->common);
}

char *batch_resuming(const struct arguments *arguments)
{
    static char resume[] = "--resume";
    struct arguments changed = *arguments;
    changed.count = 0;
    changed.words = calloc((size_t)arguments->count + 1, sizeof *changed.words);
    if (!changed.words) {
        return NULL;
    }
    for (int i = 0; i < arguments->count; i++) {
        if (strcmp(arguments->words[i], "--force") != 0 && strcmp(arguments->words[i], "--resume") != 0) {
            changed.words[changed.count++] = arguments->words[i];
        }
    }
    changed.words[changed.count++] = resume;
    char *text = arguments_text(&changed);
    free(changed.words);
    return text;
}

int batch_run_interrupted(const struct batch_run *run, int signal)
{
    char *command = run->output && !run->piped ? batch_resuming(run->arguments) : NULL;
    print_error_line("interrupted after %" PRIu64 " poses%s%s", run->file.poses, command ? "; continue with: " : "",
                     command ? command : "");
    free(command);
    return 128 + signal;
}

int batch_run_check_poses(struct batch_run *run)
{
    char hash[65] = "";
    conus_status status = run->piped ? CONUS_OK : conus_pose_stream_sha256(hash, run->poses);
    if (status) {
        return print_status(status);
    }
    if (strcmp(hash, run->pose_hash) != 0) {
        print_error_line("%s: changed while it was read", run->settings->poses);
        return EXIT_DATA;
    }
    return EXIT_DONE;
}

int batch_run_finish_output(struct batch_run *run)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_batch_sidecar(&text, &size, run->batch);
    if (status) {
        return print_status(status);
    }
    struct batch_record record = {
        .shard = run->shard,
        .first = run->first,
        .poses = run->file.poses,
        .errors = run->file.errors,
        .bytes = run->file.size,
        .header_size = strlen(conus_batch_header(run->batch)),
        .crc = run->file.crc,
        .pose_file = run->settings->poses,
        .pose_hash = run->pose_hash,
        .coordsystem = conus_pose_stream_coordsystem(run->poses),
        .coordsystem_hash = conus_pose_stream_coordsystem_sha256(run->poses),
        .level_file = settings_level_file(&run->settings->engine),
        .angle = settings_angle(&run->settings->aim, &run->settings->engine) * (180 / M_PI),
        .has_angles = conus_pose_stream_has_angles(run->poses),
        .has_ranges = conus_pose_stream_has_ranges(run->poses),
        .has_points = conus_pose_stream_has_points(run->poses),
    };
    memcpy(record.fingerprint, run->fingerprint, sizeof record.fingerprint);
    const struct engine_settings *engine = &run->settings->engine;
    bool of_shanks =
        format_is_of_probe(run->format) && (engine->range[1] > 0 || record.has_ranges); /* contacts have no range */
    const struct rows_kind *of_axis = run->settings->of_axis ? run->settings->of_axis
                                      : of_shanks            ? &settings_axis_rows[0]
                                                             : NULL;
    const struct question question = {
        .arguments = run->arguments,
        .rows = of_axis                  ? of_axis->word
                : run->settings->summary ? "summaries"
                                         : "answers",
        .region = of_axis              ? "axis"
                  : engine->radius > 0 ? "cylinder"
                                       : "cone",
    };
    int code = batch_record_write(run->sidecar, text, &record, run->command_line, &question);
    return code ? code : batch_file_finish(&run->file);
}

void batch_run_finish(struct batch_run *run)
{
    batch_file_close(&run->file);
    conus_batch_destroy(run->batch);
    for (size_t i = 0; run->aimed && i < run->atlases.count; i++) {
        conus_selector_destroy(run->aimed[i].selector);
    }
    free(run->aimed);
    atlases_finish(&run->atlases);
    conus_pose_stream_destroy(run->poses);
    free(run->sidecar);
    free(run->command_line);
}
