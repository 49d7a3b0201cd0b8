/* SPDX-License-Identifier: BSD-3-Clause */
/* A batch: its inputs, the library's batch, its file of rows; and parts, answered one by one and joined. */
#include "cli/batch/parts.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"
#include "options/provenance.h"
#include "settings/settings.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first pose that has no answer. */
struct first_error {
    uint64_t line; /* in the file of poses; 0 = there is none */
    char why[512];
};

/* Poses that are answered, and those of them without an answer. */
struct counts {
    uint64_t poses, errors;
};

struct task {
    char point_error[256], understood[96]; /* about poses that are points */
    const struct batch_settings *settings;
    const struct arguments *arguments;
    const char *format;
    conus_contacts contacts; /* from --contacts */
    double within;           /* from --clearance, mm */
    size_t notes_said;       /* of the poses */
    conus_pose_stream *poses;
    bool piped;     /* the poses can be read only once: from standard input or a named pipe */
    uint64_t total; /* poses in the file, where parts of it are answered */
    struct atlases atlases;
    conus_frame frame;          /* the space of positions */
    struct named_places places; /* how the question was understood, and the scalp */
    char *scalp[2];             /* its file, and that of its landmarks */
    conus_row_marks marks;      /* what tells rows apart */
    struct kept_names kept;     /* from --keep */
    conus_probe *probe;         /* from --probe; NULL = none */
    struct aimed *aimed;        /* [atlases.count] with what is found about the poses of the part at hand */
    conus_batch_options options;
    conus_batch *batch;
    char fingerprint[65], pose_hash[65];
    struct progress progress;
    struct counts before;           /* in whole parts */
    struct first_error first_error; /* among the poses answered since the run began */

    /* The part at hand. */
    struct shard shard;
    char *path, *sidecar;  /* NULL without an output */
    uint64_t first, count; /* poses to answer; count UINT64_MAX = all from there on */
    struct batch_file file;
    struct counts done;
    int code; /* of writing */
};

static const struct shard all_parts = {0, 1, true}; /* as one: --shard all/N */

static bool check_settings(const char **format, const struct batch_settings *settings,
                           const struct arguments *arguments)
{
    if (!batch_format(format, settings, arguments)) {
        return false;
    }
    if (settings->atlas.more.count && format_of(*format)->is_foreign) {
        return refuse("--format: formats of other programs have no column for the atlas; tsv, csv and ndjson have one");
    }
    if (settings->of_axis && format_of(*format)->is_foreign) {
        return refuse("--format: formats of other programs hold no %s; tsv, csv and ndjson do",
                      settings->of_axis->option);
    }
    if (settings->of_axis && !option_given(arguments, "output") && (settings->summary || settings->axis.order)) {
        return refuse("--%s has no effect without --output: other rows have but one order",
                      settings->summary ? "summary" : "order");
    }
    if (settings->summary && format_of(*format)->is_foreign) {
        return refuse("--summary: formats of other programs have no summary; tsv, csv and ndjson have one");
    }
    if (settings->keep.columns && format_of(*format)->is_foreign) {
        return refuse("--keep: formats of other programs have no place for it; tsv, csv and ndjson have");
    }
    if (settings->probe.path && format_of(*format)->is_foreign) {
        return refuse("--format: of many probes tsv, csv and ndjson hold the contacts; conus query --probe writes the "
                      "others");
    }
    if ((settings->force || settings->part.all) && output_is_stdout(settings->output)) {
        return refuse(settings->force ? "--force has no effect without a file for --output"
                                      : "--shard all/N needs a file for --output, beside which the parts are");
    }
    if (settings->part.count > 1 && format_of(*format)->is_of_probe) {
        return refuse("--shard: a probe's string is one whole");
    }
    return settings_check_score(&settings->engine, false) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) &&
           space_settings_check(arguments, &settings->aim.space);
}

/* Turns to the file of a part. */
static int name_file(struct task *task, struct shard shard)
{
    const char *output = output_is_stdout(task->settings->output) ? NULL : task->settings->output;
    free(task->path);
    free(task->sidecar);
    task->shard = shard;
    task->path = output ? shard_path(output, shard) : NULL;
    task->sidecar = task->path ? provenance_path(task->path) : NULL;
    if (output && !task->sidecar) {
        return print_no_memory();
    }
    int code = output ? output_check_file(task->path) : EXIT_DONE;
    return code || !output ? code : output_check_file(task->sidecar);
}

static int init_task(struct task *out, const struct batch_settings *settings, const struct arguments *arguments)
{
    *out = (struct task){.settings = settings, .arguments = arguments, .file.rows.file = -1};
    if (!check_settings(&out->format, settings, arguments)) {
        return EXIT_USAGE;
    }
    int code = keep_settings_names(&out->kept, &settings->keep);
    code = code ? code : settings_contacts(&out->contacts, settings->axis.contacts);
    out->within = option_key_number(arguments, "clearance", CLEARANCE_WITHIN);
    code = code ? code : name_file(out, settings->part.all ? all_parts : settings->part);
    for (int i = 1; out->path && i < arguments->count && !code; i++) {
        code = outputs_check_name(arguments->words[i]);
    }
    return code ? code : atlases_name(&out->atlases, arguments->operands[0], &settings->atlas);
}

static conus_pose_options pose_options(const struct task *task)
{
    const struct batch_settings *settings = task->settings;
    const conus_atlas *atlas = task->atlases.count ? task->atlases.items[0].atlas : NULL;
    conus_pose_options options = pose_settings_options(&settings->file, &settings->aim, &settings->engine, &task->frame,
                                                       atlas, settings->atlas.max_memory);
    options.scalp = task->places.scalp;
    options.keep = task->kept.at;
    options.keep_count = task->kept.count;
    options.all_rows = format_is(task->format, "bids") || format_of(task->format)->is_of_probe;
    return options;
}

/* Opens the poses, from their beginning. */
static int open_stream(struct task *task, const conus_pose_options *options)
{
    conus_pose_stream *poses = NULL;
    conus_status status = conus_pose_stream_open(&poses, task->settings->poses, options);
    if (status) {
        return pose_settings_print_error(status, task->settings->poses, "poses", task->arguments);
    }
    conus_pose_stream_destroy(task->poses);
    task->poses = poses;
    return EXIT_DONE;
}

static int match_stream(struct task *task, const struct common_settings *common)
{
    return pose_settings_match_stream(&task->notes_said, task->poses, task->settings->poses, &task->atlases,
                                      &task->settings->file, common);
}

/* Says which poses are the part's. */
static void find_range(struct task *task)
{
    task->first = 0;
    task->count = UINT64_MAX;
    if (task->shard.count > 1) {
        shard_range(&task->first, &task->count, task->shard, task->total);
    }
}

static int open_poses(struct task *task)
{
    const struct batch_settings *settings = task->settings;
    task->piped = poses_are_no_file(settings->poses);
    if (task->piped && settings->part.count > 1) {
        return print_usage_error("--shard needs a file of poses, not %s",
                                 poses_are_stdin(settings->poses) ? "standard input" : "a pipe");
    }
    task->marks.names = task->kept.at;
    task->marks.count = task->kept.count;
    const conus_pose_options options = pose_options(task);
    int code = open_stream(task, &options);
    code = code ? code : probe_settings_load(&task->probe, &settings->probe, settings->atlas.max_memory);
    if (!code && task->probe && conus_probe_count(task->probe) != 1) {
        code =
            print_data_error("%s: has %zu probes, wanted is one, which is put at each pose; conus query puts several",
                             settings->probe.path, conus_probe_count(task->probe));
    }
    code = code ? code
                : pose_settings_check_electrodes(task->format, conus_pose_stream_facts(task->poses).electrodes,
                                                 settings->poses);
    code = code ? code : pose_settings_mark_stream(&task->marks, task->poses, settings->poses, task->piped, &options);
    if (!code && settings->part.count > 1) {
        code = print_status(conus_pose_stream_count(&task->total, task->poses));
    }
    find_range(task);
    return code;
}

/* The file of the part at hand and its sidecar may be none that is read. */
static int check_file(const struct task *task)
{
    char option[64];
    snprintf(option, sizeof option, "--%s", task->settings->of_axis ? task->settings->of_axis->option : "output");
    return output_spares_inputs(option, task->path) && output_spares_inputs(option, task->sidecar)
               ? outputs_check_sidecar(task->sidecar)
               : EXIT_USAGE;
}

static int check_files(const struct task *task)
{
    struct outputs all;
    if (!task->path) {
        return output_spares_inputs("standard output", "/dev/stdout") ? EXIT_DONE : EXIT_USAGE;
    }
    outputs_collect(&all, task->arguments); /* those of later runs, too */
    int code = outputs_spare_inputs(&all) ? EXIT_DONE : EXIT_USAGE;
    code = code ? code : outputs_check_name(task->path); /* of a table of batches, too */
    code = code ? code : outputs_check_name(task->settings->poses);
    code = code ? code : atlases_check_names(&task->atlases);
    return code ? code : check_file(task);
}

static int open_task(struct task *task)
{
    const struct batch_settings *settings = task->settings;
    struct atlas_settings atlas = settings->atlas;
    atlas.answers = !settings->aim.inward; /* which may take the head of a context */
    int code = pose_settings_check_file(settings->poses, "poses", task->arguments);
    code =
        code ? code : atlases_load_all(&task->atlases, &atlas, &settings->context); /* open_poses() asks their size */
    code =
        code ? code : space_settings_frame(&task->frame, &task->atlases, &settings->aim.space, settings->common.quiet);
    code = code ? code : settings_scalp(&task->places.scalp, task->scalp, &settings->aim, &task->frame);
    code = code ? code
                : settings_scalp_match(task->places.scalp, &task->atlases, settings->file.any_space,
                                       settings->common.quiet);
    code = code ? code : open_poses(task);
    code = code ? code : check_files(task);
    return code ? code : match_stream(task, &settings->common);
}

/* Of balls around contacts, or of cylinders; mm. */
static double radius_of(const struct task *task)
{
    double radius = task->settings->engine.radius;
    return task->probe && radius == 0 ? CONUS_POINT_RADIUS : radius;
}

/* Says what is asked: an --angle that was forgotten is seen here. */
static void say_question(const struct task *task)
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
    const conus_pose_facts facts = conus_pose_stream_facts(task->poses);
    bool may_mix = format_is(facts.format, "brainsight") || format_is(facts.format, "markups") ||
                   format_is(facts.format, "nibs"); /* points and poses in one file */
    bool is_said = facts.has_points && !may_mix;
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
                 engine->radius, facts.has_points ? ", round points balls" : "");
    } else {
        snprintf(shape, sizeof shape, "%s of %g degrees%s%s", is_square ? "square pyramids" : "cones",
                 settings_angle(&settings->aim, engine),
                 option_given(task->arguments, "angle") ? ""
                 : engine->made && !isnan(conus_weight_angle(engine->made))
                     ? " (the weight's own; --angle DEGREES changes it)"
                 : facts.has_ranges ? " (the default; --angle DEGREES or, for needles, "
                                      "--radius MM changes it)"
                                    : " (the default; --angle DEGREES changes it)",
                 facts.has_angles ? " where the file has no angle" : "");
    }
    say_note(CONUS_SEVERITY_NOTE, false, "%s: %s; %u x %u rays", pose_settings_file_name(settings->poses), shape, rays,
             rays);
}

/* Makes the library's batch anew, which has then found nothing about the poses yet. */
static int create_batch(struct task *task)
{
    conus_batch_destroy(task->batch);
    task->batch = NULL;
    task->options.report.electrodes =
        format_is(task->format, "bids") ? conus_pose_stream_facts(task->poses).electrodes : NULL;
    conus_status status = conus_batch_create(&task->batch, task->aimed[0].selector, &task->options);
    for (size_t i = 1; i < task->atlases.count && !status; i++) {
        status = conus_batch_add(task->batch, task->aimed[i].selector, task->atlases.items[i].name);
    }
    return print_status(status);
}

static int build_task(struct task *task)
{
    const struct batch_settings *settings = task->settings;
    const conus_pose_facts facts = conus_pose_stream_facts(task->poses);
    conus_selector_options engine = settings_engine(&settings->engine, &settings->aim, &settings->common);
    settings_point_error(task->point_error, &settings->engine, task->arguments);
    if (format_is(facts.format, "points") && !settings->aim.inward && task->point_error[0]) {
        return print_data_error("%s: %s", pose_settings_file_name(settings->poses), task->point_error);
    }
    bool has_points = facts.has_points && !task->point_error[0] && !task->probe && !settings->of_axis &&
                      !format_of(task->format)->is_foreign;
    int code = settings_understood(task->understood, &task->places, &settings->aim, &settings->engine, has_points,
                                   facts.has_radii, facts.space);
    if (code) {
        return code;
    }
    task->options = (conus_batch_options){
        .threads = settings->threads,
        .block = settings->block,
        .angle = settings_angle(&settings->aim, &settings->engine),
        .point_error = task->point_error[0] && !task->probe ? task->point_error : NULL, /* contacts are asked */
        .report = {.rows = settings->of_axis   ? settings->of_axis->rows
                           : settings->summary ? "summaries"
                                               : "answers",
                   .format = task->format,
                   .frame = &task->frame,
                   .atlas = task->atlases.items[0].name,
                   .order = settings->of_axis ? CONUS_ORDER_RANK : (conus_order)settings->axis.order,
                   .contacts = settings->of_axis ? (conus_contacts){0} : task->contacts,
                   .within = task->within,
                   .places = task->places.items,
                   .place_count = task->places.count,
                   .points = has_points,
                   .radii = has_points && facts.has_radii,
                   .marks = &task->marks,
                   .probe = task->probe,
                   .roll = settings->probe.roll,
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
        *aimed = (struct aimed){
            .atlas = item->atlas,
            .name = item->name,
            .frame = &task->frame,
            .radius = settings_point_radius(&settings->engine, NULL, format_of(task->format)->is_foreign)};
        engine.level = i ? NULL : engine.level;
        conus_status status = conus_selector_create(&aimed->selector, item->atlas, &engine);
        if (status) {
            return print_status(status);
        }
    }
    code = create_batch(task);
    if (code) {
        return code;
    }
    if (settings->common.verbose) {
        print_error_line("engine: %s; %" PRIu32 " threads", conus_selector_engine(task->aimed[0].selector),
                         conus_batch_threads(task->batch));
    }
    say_question(task);
    atlases_say_notes(&task->atlases, &settings->common);
    atlases_say_spaces(&task->atlases, &settings->common);
    atlases_say_open(&task->atlases, &settings->engine, &settings->common);
    settings_say_weight(&settings->aim, &settings->engine, &settings->common, task->atlases.items[0].atlas);
    return EXIT_DONE;
}

/* Hashes the poses, and all that the rows depend on. */
static int identify(struct task *task)
{
    const struct batch_settings *settings = task->settings;
    const conus_atlas *atlas = task->atlases.items[0].atlas;
    const char *asked = task->arguments->operands[0];
    size_t place = 0; /* of the format, which fingerprints of earlier results have */
    while (!format_is(task->format, conus_format_at(place)->name)) {
        place++;
    }
    const char format[] = {(char)('0' + place), '\0'};
    /* AFNI's rows have the name of the atlas's file without its folder, or that of its manifest. */
    bool has_file_name = format_is(task->format, "afni");
    const conus_volume_info *info = has_file_name ? conus_atlas_volume(atlas, 0) : NULL;
    const char *first = has_file_name ? conus_atlas_file(atlas, 0) : NULL;
    const char *sidecar = NULL;
    size_t size = 0;
    char angle[512 + KEPT_SIZE], reading[128], probe_hash[65] = "";
    int length =
        snprintf(angle, sizeof angle, "%.17g%s%s", settings->aim.angle, task->marks.has_number ? " marked" : "",
                 settings->keep.columns ? settings->keep.columns : "");
    for (size_t i = 0; i < 4; i++) {
        char hash[65] = "";
        const char *file = i < 2 ? settings->engine.weight_file[i] : task->scalp[i - 2];
        int failed = file ? provenance_hash_file(hash, file) : EXIT_DONE;
        if (failed) {
            return failed;
        }
        length += snprintf(angle + length, sizeof angle - (size_t)length, "%s%s", file ? " " : "", hash);
    }
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
    const conus_pose_facts facts = conus_pose_stream_facts(task->poses);
    const char *sources[12] = {angle,
                               reading,
                               conus_batch_header(task->batch),
                               task->pose_hash,
                               facts.space,
                               facts.coordsystem_sha256,
                               format,
                               info ? path_name(info->path) : ""};
    const char **more = sources + 8;
    if (first && strcmp(first, asked) == 0) {
        *more++ = path_name(asked);
    }
    if (*words) {
        *more++ = words;
    }
    if (task->scalp[0]) { /* its landmarks */
        *more++ = settings->aim.scalp + strlen(task->scalp[0]);
    }
    int code = status        ? print_status(status)
               : task->piped ? EXIT_DONE
                             : provenance_hash_file(task->pose_hash, settings->poses);
    return code ? code : batch_fingerprint(task->fingerprint, sidecar, &task->atlases, sources);
}

/* What is there in the place of the part at hand: with `is_whole` its own file, as `record` says. What is anything else
 * is refused, unless --force replaces it. */
static int look_at_file(bool *is_whole, struct batch_record *record, const struct task *task)
{
    const int refused = task->settings->part.all && !task->shard.all ? EXIT_DATA : EXIT_USAGE;
    bool has_file = system_allows(task->path, 0);
    bool has_sidecar = system_allows(task->sidecar, 0);
    uint32_t crc = 0;
    uint64_t size = 0;
    *is_whole = false;
    if (task->settings->force || !(has_file || has_sidecar)) {
        return EXIT_DONE;
    }
    messages_hold(true);
    bool is_known = has_sidecar && !task->piped && !batch_record_read(record, NULL, 0, task->sidecar);
    messages_hold(false);
    if (!is_known || strcmp(record->fingerprint, task->fingerprint) != 0) {
        print_error_line("%s: there is a file already%s; --force replaces it", has_file ? task->path : task->sidecar,
                         is_known ? ", of other poses, atlases, settings or another version" : "");
        return refused;
    }
    if (record->shard.index != task->shard.index || record->shard.count != task->shard.count) {
        print_error_line("%s: there is a file already, which is part %" PRIu64 "/%" PRIu64 " and not %" PRIu64
                         "/%" PRIu64 "; --force replaces it",
                         task->path, record->shard.index, record->shard.count, task->shard.index, task->shard.count);
        return refused;
    }
    if (!has_file) { /* a run ended between the two */
        return EXIT_DONE;
    }
    int code = batch_file_read(&crc, &size, task->path, NULL, 0);
    if (!code && (crc != record->crc || size != record->bytes)) {
        print_error_line("%s: there is a file already, which is not the one that %s describes: %" PRIu64
                         " bytes with CRC-32 %08" PRIx32 ", not %" PRIu64 " with %08" PRIx32 "; --force replaces it",
                         task->path, task->sidecar, size, crc, record->bytes, record->crc);
        code = refused;
    }
    *is_whole = !code;
    return code;
}

static void show_progress(struct task *task)
{
    progress_update(&task->progress, task->before.poses + task->done.poses, task->before.errors + task->done.errors);
}

/* `total` UINT64_MAX: all poses. */
static void start_progress(struct task *task, uint64_t total)
{
    const struct batch_settings *settings = task->settings;
    progress_start(&task->progress, (enum progress_kind)settings->progress, settings->common.quiet, "poses", 0);
    task->progress.before = task->before.poses;
    if (progress_is_shown(&task->progress)) {
        bool known = total != UINT64_MAX || conus_pose_stream_count(&total, task->poses) == CONUS_OK;
        task->progress.total = known ? total : 0;
    }
}

static bool deliver(void *user, const conus_batch_block *block)
{
    struct task *task = user;
    struct first_error *first = &task->first_error;
    task->code = batch_file_append(&task->file, block->text, block->size);
    if (task->code) {
        return false;
    }
    task->done.poses += block->poses;
    task->done.errors += block->errors;
    if (block->errors && !first->line) {
        first->line = block->line;
        snprintf(first->why, sizeof first->why, "%s", block->why);
    }
    show_progress(task);
    return !interrupt_signal();
}

/* Says how many poses have no answer, with the first of this run; nothing where all have. */
static void say_errors(const struct task *task)
{
    const struct first_error *first = &task->first_error;
    char where[sizeof first->why + 64] = "";
    if (first->line) {
        snprintf(where, sizeof where, ", the first in line %" PRIu64 ": %s", first->line, first->why);
    }
    if (task->done.errors && !task->settings->is_again) {
        print_error_line("%s: no answer to %" PRIu64 " of %" PRIu64 " poses%s",
                         pose_settings_file_name(task->settings->poses), task->done.errors, task->done.poses, where);
    }
}

static void gather_findings(struct task *task)
{
    for (size_t i = 0; i < task->atlases.count; i++) {
        task->aimed[i].found = conus_batch_findings(task->batch, i);
        if (task->settings->aim.aperture > 0) { /* a beam begins inside */
            task->aimed[i].found.inside = (conus_pose_finding){0};
        }
    }
}

static void say_each_finding(const struct task *task)
{
    pose_settings_say_late(task->poses, task->settings->poses, task->notes_said, &task->settings->common);
    aim_notes_say(task->aimed, task->atlases.count, pose_settings_file_name(task->settings->poses),
                  &task->settings->common);
    pose_settings_warn_of_names(conus_pose_stream_facts(task->poses).head, task->settings->poses, &task->atlases);
}

static int say_interrupted(const struct task *task, int signal)
{
    uint64_t answered = task->before.poses + task->done.poses;
    if (!task->path) {
        print_error_line("interrupted after %" PRIu64 " poses", answered);
    } else if (task->settings->part.all) {
        print_error_line("interrupted after %" PRIu64 " poses, %" PRIu64
                         " of them in whole parts; the same command goes on",
                         answered, task->before.poses);
    } else {
        print_error_line(
            "interrupted after %" PRIu64 " poses, of which nothing is kept; --shard all/N keeps whole parts", answered);
    }
    return 128 + signal;
}

/* Answers the poses of the part at hand; its rows are in the file then. */
static int answer_poses(struct task *task)
{
    conus_status status = task->first ? conus_pose_stream_skip(task->poses, task->first) : CONUS_OK;
    if (status) {
        return print_status(status);
    }
    task->done = (struct counts){0};
    interrupt_catch(task->poses);
    status = conus_batch_run(task->batch, task->poses, task->count, deliver, task);
    interrupt_release();
    int signal = interrupt_signal();
    bool is_ended = status == CONUS_ERROR_CANCELLED; /* by deliver(), for its code or a signal */
    return task->code            ? task->code
           : status && !is_ended ? print_status(status)
           : signal              ? say_interrupted(task, signal)
                                 : EXIT_DONE;
}

/* Fails if the file of poses has changed since the fingerprint was taken. Reads the rest of it. */
static int check_poses(struct task *task)
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

/* Writes the sidecar of the part at hand and gives its file its name. */
static int finish_file(struct task *task)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_batch_sidecar(&text, &size, task->batch);
    char *words = task->shard.all ? arguments_text(task->arguments) : shard_words(task->arguments, task->shard);
    if (status || !words) {
        free(words);
        return status ? print_status(status) : print_no_memory();
    }
    const conus_pose_facts facts = conus_pose_stream_facts(task->poses);
    struct batch_record record = {
        .shard = task->shard,
        .first = task->first,
        .poses = task->done.poses,
        .errors = task->done.errors,
        .bytes = task->file.size,
        .header_size = strlen(conus_batch_header(task->batch)),
        .crc = task->file.crc,
        .pose_file = task->settings->poses,
        .pose_hash = task->pose_hash,
        .coordsystem = facts.coordsystem,
        .coordsystem_hash = facts.coordsystem_sha256,
        .level_file = settings_level_file(&task->settings->engine),
        .weight_files = task->settings->engine.weight_file,
        .scalp = task->scalp,
        .probe_file = task->settings->probe.path,
        .contacts = conus_probe_contact_count(task->probe),
        .angle = settings_angle(&task->settings->aim, &task->settings->engine),
        .has_angles = facts.has_angles,
        .has_ranges = facts.has_ranges,
        .has_points = facts.has_points || task->probe,
        .aimed = task->shard.count > 1 ? task->aimed : NULL,
        .atlases = task->atlases.count,
    };
    memcpy(record.fingerprint, task->fingerprint, sizeof record.fingerprint);
    const struct engine_settings *engine = &task->settings->engine;
    bool of_shanks = format_of(task->format)->is_of_probe &&
                     (engine->range.ends[1] > 0 || record.has_ranges); /* contacts have no range */
    const struct rows_kind *of_axis = task->settings->of_axis ? task->settings->of_axis
                                      : of_shanks             ? &rows_kinds[0]
                                                              : NULL;
    bool is_of_points = (engine->radius == 0 || facts.has_radii) && record.has_points && !task->aimed[0].found.poses;
    const struct question question = {
        .arguments = task->arguments,
        .rows = of_axis                   ? of_axis->rows
                : task->settings->summary ? "summaries"
                                          : "answers",
        .region = of_axis                       ? "axis"
                  : is_of_points || task->probe ? "ball"
                  : engine->radius > 0          ? "cylinder"
                                                : "cone",
    };
    int code = batch_record_write(task->sidecar, text, &record, words, &question);
    free(words);
    code = code ? code : batch_file_finish(&task->file);
    batch_file_close(&task->file);
    return code;
}

static int begin_file(struct task *task)
{
    const char *header_row = conus_batch_header(task->batch);
    int code = batch_file_begin(&task->file, task->path);
    return code ? code : batch_file_append(&task->file, header_row, strlen(header_row));
}

static void say_findings(struct task *task)
{
    say_errors(task);
    gather_findings(task);
    say_each_finding(task);
}

static void say_there(const struct task *task)
{
    say_note(CONUS_SEVERITY_NOTE, task->settings->common.quiet, "%s: is there already, with these answers", task->path);
    say_errors(task);
}

/* Answers the poses of one file, which may be a part. */
static int answer_file(struct task *task)
{
    struct batch_record record;
    bool is_whole = false;
    int code = task->path ? look_at_file(&is_whole, &record, task) : EXIT_DONE;
    if (!code && is_whole) {
        task->done = (struct counts){record.poses, record.errors};
        say_there(task);
        return EXIT_DONE;
    }
    code = code ? code : begin_file(task);
    if (code) {
        return code;
    }
    start_progress(task, task->count);
    code = answer_poses(task);
    if (!code && !task->progress.on_terminal) { /* where a program reads along, the progress has the last word */
        say_findings(task);
    }
    progress_finish(&task->progress, task->done.poses, task->done.errors);
    if (!code && task->progress.on_terminal) {
        say_findings(task);
    }
    if (!code && !task->done.poses && task->shard.count == 1) {
        pose_settings_say_none(task->settings->poses, &task->settings->common);
    }
    code = code || !task->path ? code : check_poses(task);
    return code || !task->path ? code : finish_file(task);
}

/* Reads the poses anew, for the part at hand. */
static int turn_to(struct task *task, struct shard shard)
{
    static const struct common_settings quiet = {.quiet = true}; /* it was all said */
    const conus_pose_options options = pose_options(task);
    int code = name_file(task, shard);
    code = code ? code : open_stream(task, &options);
    code = code ? code : match_stream(task, &quiet);
    code = code ? code : create_batch(task);
    find_range(task);
    return code;
}

/* Answers the part at hand among others: what its sidecar warns of is said once, of all. */
static int answer_part(struct task *task, size_t warnings)
{
    int code = begin_file(task);
    code = code ? code : answer_poses(task);
    code = code ? code : check_poses(task);
    if (!code) {
        gather_findings(task);
        messages_hold(true);
        say_each_finding(task);
        messages_hold(false);
        code = finish_file(task);
        warnings_forget(warnings);
    }
    batch_file_close(&task->file);
    if (!code) {
        task->before.poses += task->done.poses;
        task->before.errors += task->done.errors;
    }
    task->done = (struct counts){0};
    return code;
}

/* Of poses that come behind those of the sum. */
static void add_finding(conus_pose_finding *sum, const conus_pose_finding *more)
{
    uint64_t count = sum->count + more->count;
    *sum = sum->count ? *sum : *more;
    sum->count = count;
}

static void add_found(conus_pose_findings *sum, const conus_pose_findings *more)
{
    sum->poses += more->poses;
    sum->points += more->points;
    add_finding(&sum->inside, &more->inside);
    add_finding(&sum->away, &more->away);
    add_finding(&sum->tiny, &more->tiny);
    add_finding(&sum->far, &more->far);
    add_finding(&sum->apart, &more->apart);
}

/* Whether the record is that of the part at hand of this question; prints an error if it is not. */
static bool is_own_part(const struct task *task, const struct batch_record *record)
{
    return (strcmp(record->fingerprint, task->fingerprint) == 0 && record->shard.index == task->shard.index &&
            record->shard.count == task->shard.count && record->first == task->first && record->poses == task->count &&
            record->header_size == strlen(conus_batch_header(task->batch))) ||
           refuse("%s: is not part %" PRIu64 "/%" PRIu64 " of this batch: poses, atlases, settings or version differ",
                  task->path, task->shard.index, task->shard.count);
}

/* Appends the rows of the part at hand to the whole file, and adds up what is known of its poses. */
static int add_part(struct task *task, struct batch_file *whole, struct counts *sum, conus_pose_findings *found)
{
    struct batch_record record;
    uint32_t crc;
    uint64_t size;
    conus_pose_findings *own = calloc(task->atlases.count, sizeof *own);
    if (!own) {
        return print_no_memory();
    }
    int code = batch_record_read(&record, own, task->atlases.count, task->sidecar);
    code = code || is_own_part(task, &record) ? code : EXIT_DATA;
    code = code ? code : batch_file_read(&crc, &size, task->path, whole, record.header_size);
    if (!code && (crc != record.crc || size != record.bytes)) {
        code = print_data_error("%s: is not the file that %s describes", task->path, task->sidecar);
    }
    for (size_t i = 0; i < task->atlases.count && !code; i++) {
        if (!conus_atlas_object(task->atlases.items[i].atlas, own[i].inside.object) && own[i].inside.count) {
            code = print_data_error("%s: names an object that its atlas does not have", task->sidecar);
        }
        add_found(&found[i], &own[i]);
    }
    sum->poses += code ? 0 : record.poses;
    sum->errors += code ? 0 : record.errors;
    free(own);
    return code;
}

/* Removes the parts that are this question's, each behind its rows. */
static int remove_parts(struct task *task)
{
    struct shard part = {0, task->settings->part.count, false};
    int code = EXIT_DONE;
    for (; part.index < part.count && !code; part.index++) {
        struct batch_record record;
        code = name_file(task, part);
        messages_hold(true);
        bool is_own = !code && system_allows(task->sidecar, 0) && !batch_record_read(&record, NULL, 0, task->sidecar) &&
                      strcmp(record.fingerprint, task->fingerprint) == 0;
        messages_hold(false);
        if (is_own) {
            system_remove(task->path);
            system_remove(task->sidecar);
        }
    }
    return code;
}

/* Has the stream note all that it notes when a run reads all of it. */
static int read_rows(struct task *task)
{
    enum { BLOCK = 256 };
    conus_pose_row rows[BLOCK];
    size_t count = 0;
    conus_status status;
    do {
        status = conus_pose_stream_read(rows, &count, task->poses, BLOCK);
    } while (!status && count && !interrupt_signal());
    return print_status(status);
}

/* Makes the file of one run from all parts, and removes these. */
static int join_parts(struct task *task)
{
    struct shard part = {0, task->settings->part.count, false};
    struct batch_file whole = {.rows.file = -1};
    struct counts sum = {0};
    conus_pose_findings *found = calloc(task->atlases.count, sizeof *found);
    if (!found) {
        return print_no_memory();
    }
    int code = turn_to(task, all_parts);
    const char *header_row = code ? "" : conus_batch_header(task->batch);
    code = code ? code : batch_file_begin(&whole, task->settings->output);
    code = code ? code : batch_file_append(&whole, header_row, strlen(header_row));
    for (; part.index < part.count && !code; part.index++) {
        code = name_file(task, part);
        find_range(task);
        code = code ? code : add_part(task, &whole, &sum, found);
    }
    code = code ? code : read_rows(task);
    if (!code && interrupt_signal()) {
        code = say_interrupted(task, interrupt_signal());
    }
    code = code ? code : name_file(task, all_parts);
    find_range(task);
    task->file = whole; /* the task's to close */
    task->done = sum;
    task->before = (struct counts){0};
    for (size_t i = 0; i < task->atlases.count && !code; i++) {
        task->aimed[i].found = found[i];
    }
    free(found);
    if (!code) {
        say_errors(task);
        say_each_finding(task);
        code = check_poses(task);
    }
    code = code ? code : finish_file(task);
    return code ? code : remove_parts(task);
}

/* Answers every part that is not there, and joins all. What is there and no part of this batch is refused before. */
static int answer_parts(struct task *task)
{
    struct shard part = {0, task->settings->part.count, false};
    struct batch_record record;
    uint64_t there = 0;
    size_t warnings = 0;
    bool is_joined = false;
    bool *whole = calloc(part.count, sizeof *whole);
    if (!whole) {
        return print_no_memory();
    }
    int code = look_at_file(&is_joined, &record, task);
    if (!code && !is_joined && !task->settings->force) {
        code = shard_check_others(task->settings->output, part.count);
    }
    for (; part.index < part.count && !code && !is_joined; part.index++) {
        code = name_file(task, part);
        code = code ? code : check_file(task);
        code = code ? code : look_at_file(&whole[part.index], &record, task);
        if (!code && whole[part.index]) {
            there++;
            task->before.poses += record.poses;
            task->before.errors += record.errors;
        }
    }
    if (code || is_joined) { /* an earlier run ended before all its parts were gone */
        free(whole);
        task->done = code ? task->done : (struct counts){record.poses, record.errors};
        return code ? code : (say_there(task), remove_parts(task));
    }
    if (there) {
        say_note(CONUS_SEVERITY_NOTE, task->settings->common.quiet,
                 "%s: %" PRIu64 " of %" PRIu64 " parts are there already", task->settings->output, there, part.count);
    }
    while (warning_line(warnings)) {
        warnings++;
    }
    start_progress(task, task->total);
    for (part.index = 0; part.index < part.count && !code; part.index++) {
        code = whole[part.index] ? EXIT_DONE : turn_to(task, part);
        code = code || whole[part.index] ? code : answer_part(task, warnings);
    }
    free(whole);
    progress_finish(&task->progress, task->before.poses + task->done.poses, task->before.errors + task->done.errors);
    return code ? code : join_parts(task);
}

static void finish_task(struct task *task)
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
    free(task->path);
    free(task->sidecar);
    free(task->scalp[0]);
    free(task->scalp[1]);
}

int batch_answer(const struct batch_settings *settings, const struct arguments *arguments)
{
    struct task task;
    int code = init_task(&task, settings, arguments);
    code = code ? code : open_task(&task);
    code = code ? code : build_task(&task);
    code = code || !task.path ? code : identify(&task);
    code = code ? code : (settings->part.all && settings->part.count > 1 ? answer_parts : answer_file)(&task);
    code = code || !task.done.errors ? code : EXIT_DIFFERENT;
    finish_task(&task);
    return code;
}
