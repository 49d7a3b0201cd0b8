/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of a batch that conus batch and conus-mpi share: checks, inputs, the library's batch, output. */
#include "batch/batch_task.h"

#include "base/system/system.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/outputs.h"
#include "options/provenance.h"
#include "settings/notes.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool check_settings(conus_format *format, const struct batch_settings *settings,
                           const struct arguments *arguments)
{
    if (!batch_format(format, settings, arguments)) {
        return false;
    }
    if (settings->atlas.more.count && format_is_foreign(*format)) {
        return refuse("--format: formats of other programs have no column for the atlas; tsv, csv and ndjson have one");
    }
    if (settings->of_axis && format_is_foreign(*format)) {
        return refuse("--format: formats of other programs hold no %s; tsv, csv and ndjson do",
                      settings->of_axis->option);
    }
    if (settings->of_axis && !option_given(arguments, "output") && (settings->summary || settings->axis.order)) {
        return refuse("--%s has no effect without --output: other rows have but one order",
                      settings->summary ? "summary" : "order");
    }
    if (settings->summary && format_is_foreign(*format)) {
        return refuse("--summary: formats of other programs have no summary; tsv, csv and ndjson have one");
    }
    if (settings->keep.columns && format_is_foreign(*format)) {
        return refuse("--keep: formats of other programs have no place for it; tsv, csv and ndjson have");
    }
    if (settings->probe.path && format_is_foreign(*format)) {
        return refuse("--format: of many probes tsv, csv and ndjson hold the contacts; conus query --probe writes the "
                      "others");
    }
    if ((settings->force || settings->resume) && output_is_stdout(settings->output)) {
        return refuse("--%s has no effect without a file for --output", settings->force ? "force" : "resume");
    }
    return settings_check_score(&settings->engine, false) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) &&
           space_settings_check(arguments, &settings->aim.space);
}

int batch_task_init(struct batch_task *out, const struct batch_settings *settings, const struct arguments *arguments)
{
    *out = (struct batch_task){.settings = settings, .arguments = arguments, .file = {.rows = -1, .log = -1}};
    if (!check_settings(&out->format, settings, arguments)) {
        return EXIT_USAGE;
    }
    int code = keep_settings_names(&out->kept, &settings->keep);
    code = code ? code : settings_contacts(&out->contacts, settings->axis.contacts);
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
static int open_poses(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    const conus_atlas *atlas = task->atlases.count ? task->atlases.items[0].atlas : NULL;
    conus_pose_options options = pose_settings_options(&settings->file, &settings->aim, &settings->engine, &task->frame,
                                                       atlas, settings->atlas.max_memory);
    options.keep = task->marks.names = task->kept.at;
    options.keep_count = task->marks.count = task->kept.count;
    options.all_rows = task->format == CONUS_FORMAT_BIDS || format_is_of_probe(task->format);
    int code = batch_shard(&task->shard, settings);
    if (code) {
        return code;
    }
    if (task->shard.count > 1 && format_is_of_probe(task->format)) {
        return print_usage_error("--shard: a probe's string is one whole");
    }
    task->piped = poses_are_no_file(settings->poses);
    if (task->piped && (task->shard.count > 1 || settings->resume)) {
        return print_usage_error("%s needs a file of poses, not %s", settings->resume ? "--resume" : "--shard",
                                 poses_are_stdin(settings->poses) ? "standard input" : "a pipe");
    }
    conus_status status = conus_pose_stream_open(&task->poses, settings->poses, &options);
    if (status) {
        return pose_settings_print_error(status, settings->poses, "poses", task->arguments);
    }
    code = probe_settings_load(&task->probe, &settings->probe, settings->atlas.max_memory);
    if (!code && task->probe && conus_probe_count(task->probe) != 1) {
        code =
            print_data_error("%s: has %zu probes, wanted is one, which is put at each pose; conus query puts several",
                             settings->probe.path, conus_probe_count(task->probe));
    }
    code =
        code ? code
             : pose_settings_check_electrodes(task->format, conus_pose_stream_electrodes(task->poses), settings->poses);
    if (code) {
        return code;
    }
    code = pose_settings_mark_stream(&task->marks, task->poses, settings->poses, task->piped, &options);
    if (code) {
        return code;
    }
    task->count = UINT64_MAX;
    if (task->shard.count > 1) {
        uint64_t total;
        status = conus_pose_stream_count(&total, task->poses);
        if (status) {
            return print_status(status);
        }
        shard_range(&task->first, &task->count, task->shard, total);
    }
    return EXIT_DONE;
}

/* No file that is written, partial file and journal included, may be one that is read. */
static int check_files(const struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    const struct {
        const char *path, *ending;
    } written[] = {{task->sidecar, ""}, {task->output, ""}, {task->output, ".part"}, {task->output, ".journal"}};
    char option[64];
    struct outputs all;
    if (!task->output) {
        return output_spares_inputs("standard output", "/dev/stdout") ? EXIT_DONE : EXIT_USAGE;
    }
    snprintf(option, sizeof option, "--%s", settings->of_axis ? settings->of_axis->option : "output");
    outputs_collect(&all, task->arguments); /* those of later runs, too */
    int code = outputs_spare_inputs(&all) ? EXIT_DONE : EXIT_USAGE;
    code = code ? code : outputs_check_name(task->output); /* of a table of batches, too */
    code = code ? code : outputs_check_name(settings->poses);
    code = code ? code : atlases_check_names(&task->atlases);
    for (size_t i = 0; !code && i < sizeof written / sizeof written[0]; i++) {
        char *path = NULL;
        if (asprintf(&path, "%s%s", written[i].path, written[i].ending) < 0) {
            return print_no_memory();
        }
        code = output_spares_inputs(option, path) ? EXIT_DONE : EXIT_USAGE;
        free(path);
    }
    return code ? code : outputs_check_sidecar(task->sidecar);
}

int batch_task_open(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    struct atlas_settings atlas = settings->atlas;
    atlas.answers = true;
    int code = pose_settings_check_file(settings->poses, "poses", task->arguments);
    code =
        code ? code : atlases_load_all(&task->atlases, &atlas, &settings->context); /* open_poses() asks their size */
    code =
        code ? code : space_settings_frame(&task->frame, &task->atlases, &settings->aim.space, settings->common.quiet);
    code = code ? code : open_poses(task);
    code = code ? code : check_files(task);
    return code ? code
                : pose_settings_match_stream(&task->notes_said, task->poses, settings->poses, &task->atlases,
                                             &settings->file, &settings->common);
}

/* Of balls around contacts, or of cylinders; mm. */
static double radius_of(const struct batch_task *task)
{
    double radius = task->settings->engine.radius;
    return task->probe && radius == 0 ? CONUS_POINT_RADIUS : radius;
}

/* Says what is asked: an --angle that was forgotten is seen here. */
static void say_question(const struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    const struct engine_settings *engine = &settings->engine;
    bool is_square = engine->aperture == CONUS_APERTURE_SQUARE;
    uint32_t rays = conus_selector_resolution(task->aimed[0].selector);
    char shape[160];
    if (task->probe && !settings->common.quiet) {
        double tip[3];
        conus_probe_tip(tip, task->probe, 0);
        char what[64] = "what they are in";
        if (settings->engine.radius > 0) {
            snprintf(what, sizeof what, "what is within %g mm of them", settings->engine.radius);
        }
        say_note(CONUS_SEVERITY_NOTE, false,
                 "%s: the %zu contacts of %s at each pose, and %s; the tip is at x %g, y %g um",
                 pose_settings_file_name(settings->poses), conus_probe_contact_count(task->probe), settings->probe.path,
                 what, tip[0], tip[1]);
        return;
    }
    const conus_pose_format format = conus_pose_stream_format(task->poses);
    bool may_mix = format == CONUS_POSE_FORMAT_BRAINSIGHT || format == CONUS_POSE_FORMAT_MARKUPS ||
                   format == CONUS_POSE_FORMAT_NIBS; /* points and poses in one file */
    bool is_said = conus_pose_stream_has_points(task->poses) && !may_mix;
    if (task->understood[0]) {
        say_note(CONUS_SEVERITY_NOTE, settings->common.quiet || settings->is_again, "%s: %s",
                 pose_settings_file_name(settings->poses), task->understood);
    }
    bool is_beam = settings->aim.aperture > 0;
    if (settings->common.quiet || settings->of_axis || settings->is_again || is_said || is_beam) {
        return;
    }
    if (engine->radius > 0) {
        snprintf(shape, sizeof shape, "%s %g mm%s", is_square ? "square rods of half width" : "cylinders of radius",
                 engine->radius, conus_pose_stream_has_points(task->poses) ? ", round points balls" : "");
    } else {
        snprintf(shape, sizeof shape, "%s of %g degrees%s%s", is_square ? "square pyramids" : "cones",
                 settings_angle(&settings->aim, engine) * (180 / M_PI),
                 option_given(task->arguments, "angle") ? "" : " (--angle DEGREES is not given)",
                 conus_pose_stream_has_angles(task->poses) ? " where the file has no angle" : "");
    }
    say_note(CONUS_SEVERITY_NOTE, false, "%s: %s; %u x %u rays", pose_settings_file_name(settings->poses), shape, rays,
             rays);
}

int batch_task_build(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    conus_selector_options engine = settings_engine(&settings->engine, &settings->aim, &settings->common);
    settings_point_error(task->point_error, &settings->engine, task->arguments);
    if (conus_pose_stream_format(task->poses) == CONUS_POSE_FORMAT_POINTS && task->point_error[0]) {
        return print_data_error("%s: %s", pose_settings_file_name(settings->poses), task->point_error);
    }
    bool has_points = conus_pose_stream_has_points(task->poses) && !task->point_error[0] && !task->probe &&
                      !settings->of_axis && !format_is_foreign(task->format);
    int code = settings_understood(task->understood, &task->places, &settings->aim, &settings->engine, has_points);
    if (code) {
        return code;
    }
    const conus_batch_options options = {
        .threads = settings->threads,
        .block = settings->block,
        .angle = settings_angle(&settings->aim, &settings->engine),
        .point_error = task->point_error[0] && !task->probe ? task->point_error : NULL, /* contacts are asked */
        .report = {.rows = settings->of_axis   ? settings->of_axis->rows
                           : settings->summary ? CONUS_ROWS_SUMMARIES
                                               : CONUS_ROWS_ANSWERS,
                   .format = task->format,
                   .frame = &task->frame,
                   .electrodes = task->format == CONUS_FORMAT_BIDS ? conus_pose_stream_electrodes(task->poses) : NULL,
                   .atlas = task->atlases.items[0].name,
                   .order = settings->of_axis ? CONUS_ORDER_RANK : (conus_order)settings->axis.order,
                   .contacts = settings->of_axis ? (conus_contacts){0} : task->contacts,
                   .within = task->within,
                   .places = task->places.items,
                   .place_count = task->places.count,
                   .points = has_points,
                   .marks = &task->marks,
                   .probe = task->probe,
                   .roll = radians(settings->probe.roll),
                   .depth = settings->engine.range.ends[1]},
    };
    engine.radius = radius_of(task);
    if (task->probe) {
        engine.range[0] = engine.range[1] = 0; /* of the shanks */
    }
    task->aimed = calloc(task->atlases.count, sizeof *task->aimed);
    if (!task->aimed) {
        return print_no_memory();
    }
    for (size_t i = 0; i < task->atlases.count; i++) {
        const struct named_atlas *item = &task->atlases.items[i];
        struct aimed *aimed = &task->aimed[i];
        *aimed = (struct aimed){.atlas = item->atlas,
                                .name = item->name,
                                .frame = &task->frame,
                                .radius = settings_point_radius(&settings->engine, format_is_foreign(task->format))};
        engine.level = i ? NULL : engine.level;
        conus_status status = conus_selector_create(&aimed->selector, item->atlas, &engine);
        status = status   ? status
                 : i == 0 ? conus_batch_create(&task->batch, aimed->selector, &options)
                          : conus_batch_add(task->batch, aimed->selector, item->name);
        if (status) {
            return print_status(status);
        }
    }
    if (settings->common.verbose) {
        print_error_line("engine: %s; %" PRIu32 " threads", conus_selector_engine(task->aimed[0].selector),
                         conus_batch_threads(task->batch));
    }
    say_question(task);
    atlases_say_notes(&task->atlases, &settings->common);
    atlases_say_spaces(&task->atlases, &settings->common);
    atlases_say_open(&task->atlases, &settings->engine, &settings->common);
    return EXIT_DONE;
}

/* Hashes the poses, and all that the rows depend on. */
static int identify(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    const conus_atlas *atlas = task->atlases.items[0].atlas;
    const char *asked = task->arguments->operands[0];
    const char format[] = {(char)('0' + task->format), '\0'};
    /* AFNI's rows have the name of the atlas's file without its folder, or that of its manifest. */
    bool has_file_name = task->format == CONUS_FORMAT_AFNI;
    const conus_volume_info *info = has_file_name ? conus_atlas_volume(atlas, 0) : NULL;
    const char *first = has_file_name ? conus_atlas_file(atlas, 0) : NULL;
    const char *sidecar = NULL;
    size_t size = 0;
    char angle[256 + KEPT_SIZE], reading[128], probe_hash[65] = "";
    int length =
        snprintf(angle, sizeof angle, "%.17g%s%s", settings->aim.angle, task->marks.has_number ? " marked" : "",
                 settings->keep.columns ? settings->keep.columns : "");
    if (task->probe) {
        int failed = provenance_hash_file(probe_hash, settings->probe.path);
        if (failed) {
            return failed;
        }
        snprintf(angle + length, sizeof angle - (size_t)length, " %s %.17g %.17g %.17g", probe_hash,
                 settings->probe.tip, settings->probe.roll, settings->engine.range.ends[1]);
    }
    pose_settings_text(reading, &settings->file, &settings->aim, &settings->engine);
    conus_status status = conus_batch_sidecar(&sidecar, &size, task->batch);
    const char *words = settings->poses + conus_pose_path_length(settings->poses); /* by which they are read */
    const char *sources[11] = {angle,
                               reading,
                               conus_batch_header(task->batch),
                               task->pose_hash,
                               conus_pose_stream_space(task->poses),
                               conus_pose_stream_coordsystem_sha256(task->poses),
                               format,
                               info ? path_name(info->path) : ""};
    const char **more = sources + 8;
    if (first && strcmp(first, asked) == 0) {
        *more++ = path_name(asked);
    }
    if (*words) {
        *more++ = words;
    }
    int code = status        ? print_status(status)
               : task->piped ? EXIT_DONE
                             : provenance_hash_file(task->pose_hash, settings->poses);
    return code ? code : batch_fingerprint(task->fingerprint, sidecar, &task->atlases, sources);
}

/* Whether an earlier run has written all of it; takes over what that run counted. */
static bool is_complete(struct batch_task *task)
{
    struct batch_record record;
    struct system_stat info;
    if (batch_file_is_begun(task->output) || !system_allows(task->output, 0) || !system_allows(task->sidecar, 0) ||
        batch_record_read(&record, task->sidecar) || strcmp(record.fingerprint, task->fingerprint) != 0 ||
        record.shard.index != task->shard.index || record.shard.count != task->shard.count ||
        !system_stat(&info, task->output) || info.size != record.bytes) {
        return false;
    }
    task->file.poses = record.poses;
    task->file.errors = record.errors;
    task->file.is_finished = true;
    return true;
}

int batch_task_open_output(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    char fingerprint[160];
    if (!task->output) {
        const char *header_row = conus_batch_header(task->batch);
        return output_write(NULL, header_row, strlen(header_row));
    }
    int code = identify(task);
    if (code || (settings->resume && is_complete(task))) {
        return code;
    }
    const char *there = system_allows(task->output, 0) ? task->output : task->sidecar;
    if (!batch_file_is_begun(task->output) && !settings->force && system_allows(there, 0)) {
        return print_usage_error("%s: there is a file already; --force replaces it", there);
    }
    snprintf(fingerprint, sizeof fingerprint, "%s %" PRIu64 "/%" PRIu64, task->fingerprint, task->shard.index,
             task->shard.count);
    return batch_file_open(&task->file, task->output, fingerprint, conus_batch_header(task->batch),
                           settings->force    ? BATCH_FORCE
                           : settings->resume ? BATCH_RESUME
                                              : BATCH_ANEW);
}

int batch_task_skip(struct batch_task *task, uint64_t poses)
{
    conus_status status = poses ? conus_pose_stream_skip(task->poses, poses) : CONUS_OK;
    return print_status(status);
}

void batch_task_start_progress(struct batch_task *task)
{
    const struct batch_settings *settings = task->settings;
    progress_start(&task->progress, (enum progress_kind)settings->progress, settings->common.quiet, "poses", 0);
    task->progress.before = task->file.poses;
    if (progress_is_shown(&task->progress)) {
        uint64_t total = task->count;
        bool known = total != UINT64_MAX || conus_pose_stream_count(&total, task->poses) == CONUS_OK;
        task->progress.total = known ? total : 0;
    }
}

void batch_task_keep_error(struct batch_task *task, const conus_batch_block *block)
{
    struct first_error *first = &task->first_error;
    if (block->errors && !first->line) {
        first->line = block->line;
        snprintf(first->why, sizeof first->why, "%s", block->why);
    }
}

void batch_task_say_errors(const struct batch_task *task)
{
    const struct first_error *first = &task->first_error;
    char where[sizeof first->why + 64] = "";
    if (first->line) {
        snprintf(where, sizeof where, ", the first in line %" PRIu64 ": %s", first->line, first->why);
    }
    if (task->file.errors && !task->settings->is_again) {
        print_error_line("%s: no answer to %" PRIu64 " of %" PRIu64 " poses%s",
                         pose_settings_file_name(task->settings->poses), task->file.errors, task->file.poses, where);
    }
}

void batch_task_find_astray(struct batch_task *task)
{
    for (size_t i = 0; i < task->atlases.count; i++) {
        task->aimed[i].found = conus_batch_astray_at(task->batch, i);
        if (task->settings->aim.aperture > 0) { /* a beam begins inside */
            task->aimed[i].found.inside = (conus_oddity){0};
        }
    }
}

void batch_task_say_astray(const struct batch_task *task)
{
    pose_settings_say_late(task->poses, task->settings->poses, task->notes_said, &task->settings->common);
    aim_notes_say(task->aimed, task->atlases.count, pose_settings_file_name(task->settings->poses),
                  &task->settings->common);
    pose_settings_warn_of_names(conus_pose_stream_head(task->poses), task->settings->poses, &task->atlases);
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

int batch_task_interrupted(const struct batch_task *task, int signal)
{
    char *command = task->output && !task->piped ? batch_resuming(task->arguments) : NULL;
    print_error_line("interrupted after %" PRIu64 " poses%s%s", task->file.poses, command ? "; continue with: " : "",
                     command ? command : "");
    free(command);
    return 128 + signal;
}

int batch_task_check_poses(struct batch_task *task)
{
    char hash[65] = "";
    conus_status status = task->piped ? CONUS_OK : conus_pose_stream_sha256(hash, task->poses);
    if (status) {
        return print_status(status);
    }
    if (strcmp(hash, task->pose_hash) != 0) {
        return print_data_error("%s: changed while it was read", task->settings->poses);
    }
    return EXIT_DONE;
}

int batch_task_finish_output(struct batch_task *task)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_batch_sidecar(&text, &size, task->batch);
    if (status) {
        return print_status(status);
    }
    struct batch_record record = {
        .shard = task->shard,
        .first = task->first,
        .poses = task->file.poses,
        .errors = task->file.errors,
        .bytes = task->file.size,
        .header_size = strlen(conus_batch_header(task->batch)),
        .crc = task->file.crc,
        .pose_file = task->settings->poses,
        .pose_hash = task->pose_hash,
        .coordsystem = conus_pose_stream_coordsystem(task->poses),
        .coordsystem_hash = conus_pose_stream_coordsystem_sha256(task->poses),
        .level_file = settings_level_file(&task->settings->engine),
        .probe_file = task->settings->probe.path,
        .contacts = conus_probe_contact_count(task->probe),
        .angle = settings_angle(&task->settings->aim, &task->settings->engine) * (180 / M_PI),
        .has_angles = conus_pose_stream_has_angles(task->poses),
        .has_ranges = conus_pose_stream_has_ranges(task->poses),
        .has_points = conus_pose_stream_has_points(task->poses) || task->probe,
    };
    memcpy(record.fingerprint, task->fingerprint, sizeof record.fingerprint);
    const struct engine_settings *engine = &task->settings->engine;
    bool of_shanks = format_is_of_probe(task->format) &&
                     (engine->range.ends[1] > 0 || record.has_ranges); /* contacts have no range */
    const struct rows_kind *of_axis = task->settings->of_axis ? task->settings->of_axis
                                      : of_shanks             ? &settings_axis_rows[0]
                                                              : NULL;
    bool is_of_points = engine->radius == 0 && record.has_points && !task->aimed[0].found.poses;
    const struct question question = {
        .arguments = task->arguments,
        .rows = of_axis                   ? of_axis->word
                : task->settings->summary ? "summaries"
                                          : "answers",
        .region = of_axis                       ? "axis"
                  : is_of_points || task->probe ? "ball"
                  : engine->radius > 0          ? "cylinder"
                                                : "cone",
    };
    int code = batch_record_write(task->sidecar, text, &record, task->command_line, &question);
    return code ? code : batch_file_finish(&task->file);
}

void batch_task_finish(struct batch_task *task)
{
    batch_file_close(&task->file);
    conus_batch_destroy(task->batch);
    for (size_t i = 0; task->aimed && i < task->atlases.count; i++) {
        conus_selector_destroy(task->aimed[i].selector);
    }
    free(task->aimed);
    atlases_finish(&task->atlases);
    named_places_finish(&task->places);
    conus_pose_stream_destroy(task->poses);
    conus_probe_destroy(task->probe);
    free(task->sidecar);
    free(task->command_line);
}
