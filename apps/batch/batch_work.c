/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of a batch that conus batch and conus-mpi share: checks, loading, fingerprint, selector. */
#include "batch/batch_work.h"

#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/aim_notes.h"
#include "settings/atlas_notes.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void work_finish(struct work *work)
{
    conus_batch_destroy(work->batch);
    for (size_t i = 0; work->selectors && i < work->atlases.count; i++) {
        conus_selector_destroy(work->selectors[i]);
    }
    free((void *)work->selectors);
    free(work->astray);
    atlases_finish(&work->atlases);
    conus_pose_stream_destroy(work->poses);
    free(work->sidecar);
    free(work->command_line);
}

static bool check_settings(conus_format *format, const struct batch_settings *settings,
                           const struct arguments *arguments)
{
    if (!batch_format(format, settings, arguments)) {
        return false;
    }
    if (settings->atlas.more.count && *format > CONUS_FORMAT_NDJSON) {
        print_error_line("--format: other programs' have no column for the atlas, tsv, csv and ndjson do");
        return false;
    }
    if (settings->of_segments && *format > CONUS_FORMAT_NDJSON) {
        print_error_line("--format: other programs' are not of segments, tsv, csv and ndjson are");
        return false;
    }
    if (settings->of_segments && !option_given(arguments, "output") && (settings->summary || settings->axis.order)) {
        print_error_line("--%s has no effect without --output, segments have but one order",
                         settings->summary ? "summary" : "order");
        return false;
    }
    if (settings->summary && *format > CONUS_FORMAT_NDJSON) {
        print_error_line("--summary: other programs' formats have none, tsv, csv and ndjson do");
        return false;
    }
    if (!settings_check_slices(&settings->engine, arguments, "slices") ||
        !settings_check_slices(&settings->engine, arguments, "slice-fraction")) {
        return false;
    }
    if ((settings->force || settings->resume) && output_is_stdout(settings->output)) {
        print_error_line("--%s has no effect without a file for --output", settings->force ? "force" : "resume");
        return false;
    }
    return settings_check_score(&settings->engine, false) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) && settings_check_context(arguments) &&
           settings_check_space(arguments, &settings->aim.space) && options_exclude(arguments, "force", "resume");
}

/* Which of them are this shard's. */
static int choose_poses(struct work *work)
{
    uint64_t total;
    work->count = UINT64_MAX;
    if (work->shard.count == 1) {
        return EXIT_DONE;
    }
    conus_status status = conus_pose_stream_count(&total, work->poses);
    if (status) {
        return print_status(status);
    }
    shard_range(&work->first, &work->count, work->shard, total);
    return EXIT_DONE;
}

bool work_is_pipe(const char *path)
{
    struct stat info;
    return output_is_stdout(path) || (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
}

static int open_poses(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const conus_pose_options options = settings_pose_options(&settings->file, &work->frame, settings->atlas.max_memory);
    int code = batch_shard(&work->shard, settings);
    if (code) {
        return code;
    }
    if (work->shard.count > 1 && (work->format == CONUS_FORMAT_SPIKEGLX || work->format == CONUS_FORMAT_OPEN_EPHYS)) {
        return print_usage_error("--shard: a probe's string is one whole; --jobs answers many probes");
    }
    work->piped = work_is_pipe(settings->poses);
    if (work->piped && (work->shard.count > 1 || settings->resume)) {
        return print_usage_error("%s needs a file of poses, not %s", settings->resume ? "--resume" : "--shard",
                                 output_is_stdout(settings->poses) ? "standard input" : "a pipe");
    }
    conus_status status = conus_pose_stream_open(&work->poses, settings->poses, &options);
    if (status) {
        return settings_print_poses_error(status, settings->poses, "poses", work->arguments);
    }
    code = settings_check_electrodes(work->format, conus_pose_stream_electrodes(work->poses), settings->poses);
    return code ? code : choose_poses(work);
}

int work_pass_over(struct work *work, uint64_t poses)
{
    conus_status status = poses ? conus_pose_stream_skip(work->poses, poses) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
}

/* No file that is written, of those on the way neither, may be one that is read. */
static int check_files(const struct work *work)
{
    static const char *const endings[] = {"", ".part", ".journal"};
    const struct batch_settings *settings = work->settings;
    const struct input inputs[] = {{"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->poses},
                                   {"the coordinate system", conus_pose_stream_coordsystem(work->poses)},
                                   {"the table of batches", settings->jobs},
                                   {0}};
    const char *input = work->output ? atlases_input(&work->atlases, inputs, work->sidecar) : NULL;
    const char *option = settings->of_segments ? "--segments" : "--output";
    int code = input ? print_usage_error("%s would overwrite %s %s", option, input, work->sidecar) : EXIT_DONE;
    code = code || !work->output ? code : outputs_check_name(work->output); /* of a table of batches, too */
    code = code || !work->output ? code : outputs_check_name(settings->poses);
    code = code || !work->output ? code : atlases_check_names(&work->atlases);
    for (size_t i = 0; work->output && !code && i < sizeof endings / sizeof endings[0]; i++) {
        char *path = NULL;
        if (asprintf(&path, "%s%s", work->output, endings[i]) < 0) {
            print_error_line("not enough memory");
            return EXIT_DATA;
        }
        input = atlases_input(&work->atlases, inputs, path);
        code = input ? print_usage_error("%s would overwrite %s %s", option, input, path) : EXIT_DONE;
        free(path);
    }
    code = code || !work->output ? code : outputs_check_sidecar(work->sidecar);
    return code;
}

/* Those that are there already are shared, with their context. */
static int load_atlases(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    struct atlases *atlases = &work->atlases;
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

/* The selectors, and the batch of them all. */
static conus_status make_batch(struct work *work, const conus_selector_options *engine,
                               const conus_batch_options *options)
{
    conus_selector_options own = *engine;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < work->atlases.count && !status; i++) {
        const struct named_atlas *item = &work->atlases.items[i];
        own.level = i ? NULL : engine->level;
        status = conus_selector_create(&work->selectors[i], item->atlas, &own);
        status = status   ? status
                 : i == 0 ? conus_batch_create(&work->batch, work->selectors[0], options)
                          : conus_batch_add(work->batch, work->selectors[i], item->name);
    }
    return status;
}

int work_build(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const conus_selector_options engine = settings_engine(&settings->engine, &settings->common);
    const conus_batch_options options = {
        .threads = settings->threads,
        .block = settings->block,
        .angle = settings_angle(&settings->aim, &settings->engine),
        .report = {.rows = settings->of_segments ? CONUS_ROWS_SEGMENTS
                           : settings->summary   ? CONUS_ROWS_SUMMARIES
                                                 : CONUS_ROWS_ANSWERS,
                   .format = work->format,
                   .frame = &work->frame,
                   .electrodes = work->format == CONUS_FORMAT_BIDS ? conus_pose_stream_electrodes(work->poses) : NULL,
                   .atlas = work->atlases.items[0].name,
                   .order = settings->of_segments ? CONUS_ORDER_RANK : (conus_order)settings->axis.order,
                   .contacts = settings->of_segments ? (conus_contacts){0} : work->contacts},
    };
    work->selectors = calloc(work->atlases.count, sizeof(conus_selector *));
    work->astray = calloc(work->atlases.count, sizeof *work->astray);
    if (!work->selectors || !work->astray) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    conus_status status = make_batch(work, &engine, &options);
    if (!status && settings->common.verbose) {
        print_error_line("engine: %s; %" PRIu32 " threads", conus_selector_engine(work->selectors[0]),
                         conus_batch_threads(work->batch));
    }
    if (status) {
        return print_status(status);
    }
    atlases_say_notes(&work->atlases, &settings->common);
    atlases_say_spaces(&work->atlases, &settings->common);
    atlases_say_open(&work->atlases, &settings->engine, &settings->common);
    return EXIT_DONE;
}

int work_init(struct work *out, const struct batch_settings *settings, const struct arguments *arguments)
{
    *out = (struct work){.settings = settings, .arguments = arguments};
    if (!check_settings(&out->format, settings, arguments)) {
        return EXIT_USAGE;
    }
    int code = settings_contacts(&out->contacts, &settings->axis);
    if (code) {
        return code;
    }
    out->output = output_is_stdout(settings->output) ? NULL : settings->output;
    out->command_line = arguments_text(arguments);
    out->sidecar = out->output ? provenance_path(out->output) : NULL;
    if (!out->command_line || (out->output && !out->sidecar)) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    code = out->output ? output_check_file(out->output) : EXIT_DONE;
    code = code || !out->sidecar ? code : output_check_file(out->sidecar);
    for (int i = 1; out->output && i < arguments->count && !code; i++) {
        code = outputs_check_name(arguments->words[i]);
    }
    return code ? code : atlases_name(&out->atlases, arguments->operands[0], &settings->atlas);
}

int work_open(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    bool late = settings_space_needs_atlas(&settings->aim.space);
    int code = late ? load_atlases(work) : EXIT_DONE;
    code = code ? code : settings_frame(&work->frame, &work->atlases, &settings->aim.space, settings->common.quiet);
    code = code ? code : open_poses(work);
    code = code || late ? code : load_atlases(work);
    code = code ? code : check_files(work);
    return code ? code
                : settings_match_stream(work->poses, settings->poses, &work->atlases, &settings->file,
                                        &settings->common);
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* What a format writes that is not in the sidecar: AFNI's has the name of the atlas's file, but not its folder. */
static const char *file_in_rows(const struct work *work)
{
    const conus_volume_info *info = conus_atlas_volume(work->atlases.items[0].atlas, 0);
    return info && work->format == CONUS_FORMAT_AFNI ? name_of(info->path) : "";
}

/* Likewise of a manifest, whose name it may have instead; NULL if the atlas is none. */
static const char *manifest_in_rows(const struct work *work)
{
    const char *asked = work->arguments->operands[0];
    const char *first = work->format == CONUS_FORMAT_AFNI ? conus_atlas_file(work->atlases.items[0].atlas, 0) : NULL;
    return first && strcmp(first, asked) == 0 ? name_of(asked) : NULL;
}

int work_identify(struct work *work)
{
    const struct batch_settings *settings = work->settings;
    const char format[] = {(char)('0' + work->format), '\0'};
    const char *const sources[] = {work->pose_hash,
                                   conus_pose_stream_space(work->poses),
                                   conus_pose_stream_coordsystem_sha256(work->poses),
                                   format,
                                   file_in_rows(work),
                                   manifest_in_rows(work),
                                   NULL};
    int code = work->piped ? EXIT_DONE : provenance_hash_file(work->pose_hash, settings->poses);
    return code ? code : batch_fingerprint(work->fingerprint, work->batch, &work->atlases, settings, sources);
}

void work_find_aims(struct work *work)
{
    for (size_t i = 0; i < work->atlases.count; i++) {
        work->astray[i] = conus_batch_astray_at(work->batch, i);
    }
}

void work_say_aims(const struct work *work)
{
    size_t count = work->atlases.count;
    struct aimed *aimed = calloc(count, sizeof *aimed);
    for (size_t i = 0; aimed && i < count; i++) {
        const struct named_atlas *at = &work->atlases.items[i];
        aimed[i] = (struct aimed){&work->astray[i], work->selectors[i], at->atlas, at->name, &work->frame};
    }
    if (aimed) {
        aim_notes_say(aimed, count, settings_poses_name(work->settings->poses), &work->settings->common);
    }
    free(aimed);
}

void work_keep_error(struct work *work, const conus_batch_block *block)
{
    struct first_error *first = &work->first_error;
    if (block->errors && !first->line) {
        first->line = block->line;
        snprintf(first->why, sizeof first->why, "%s", block->why);
    }
}

void work_say_errors(const struct work *work, uint64_t poses, uint64_t errors)
{
    const struct first_error *first = &work->first_error;
    bool is_said = work->settings->of_segments && option_given(work->arguments, "output"); /* by the run before */
    char where[sizeof first->why + 64] = "";
    if (first->line) {
        snprintf(where, sizeof where, ", the first in line %" PRIu64 ": %s", first->line, first->why);
    }
    if (errors && !is_said) {
        print_error_line("%s: no answer to %" PRIu64 " of %" PRIu64 " poses%s",
                         settings_poses_name(work->settings->poses), errors, poses, where);
    }
}

int work_check_poses(struct work *work)
{
    char hash[65] = "";
    conus_status status = work->piped ? CONUS_OK : conus_pose_stream_sha256(hash, work->poses);
    if (!status && strcmp(hash, work->pose_hash) != 0) {
        print_error_line("%s: changed while it was read", work->settings->poses);
        return EXIT_DATA;
    }
    return status ? print_status(status) : EXIT_DONE;
}

int work_check_output(const struct work *work)
{
    const char *there = access(work->output, F_OK) == 0 ? work->output : work->sidecar;
    if (!work->settings->force && access(there, F_OK) == 0) {
        return print_usage_error("%s: there is a file already; --force replaces it", there);
    }
    return EXIT_DONE;
}

int work_write_sidecar(struct work *work, struct batch_record *record)
{
    const char *text = NULL;
    size_t size = 0;
    double angle = settings_angle(&work->settings->aim, &work->settings->engine);
    record->shard = work->shard;
    record->first = work->first;
    record->header_size = strlen(conus_batch_header(work->batch));
    record->pose_file = work->settings->poses;
    record->pose_hash = work->pose_hash;
    record->coordsystem = conus_pose_stream_coordsystem(work->poses);
    record->coordsystem_hash = conus_pose_stream_coordsystem_sha256(work->poses);
    record->level_file = settings_level_file(&work->settings->engine);
    record->angle = angle * (180 / M_PI);
    record->has_angles = conus_pose_stream_has_angles(work->poses);
    record->has_points = conus_pose_stream_has_points(work->poses);
    memcpy(record->fingerprint, work->fingerprint, sizeof record->fingerprint);
    conus_status status = conus_batch_sidecar(&text, &size, work->batch);
    return status ? print_status(status) : batch_record_write(work->sidecar, text, record, work->command_line);
}
