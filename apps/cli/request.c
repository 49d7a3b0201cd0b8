/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps that commands that answer share: checks, loading, matching, rows without an answer, notes. */
#include "cli/request.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct option request_level_options[] = {
    {OPTION_VALUED("level", struct request_settings, engine.level, "LEVEL"),
     .help = "report areas at this depth of the area tree (1 = its roots), or as these areas: names, @FILE",
     .words = "hierarchy, ontology", .common = true, .role = OPTION_READS_NAMES, .holds = HOLDS_NAMES},
    {0},
};

bool request_check(const struct request_settings *settings, const struct arguments *arguments, bool has_history)
{
    return settings_check_score(&settings->engine, has_history) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) &&
           space_settings_check(arguments, &settings->aim.space);
}

int request_init(struct request *out, const struct request_settings *settings, const struct arguments *arguments)
{
    *out = (struct request){.settings = settings, .arguments = arguments};
    if (!answer_format(&out->format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    out->command_line = arguments_text(arguments);
    if (!out->command_line) {
        return print_no_memory();
    }
    int code = answer_sidecar(&out->sidecar, out->format, &settings->answer);
    outputs_collect(&out->outputs, arguments);
    if (!settings->answer.sidecar) {
        outputs_add_sidecar(&out->outputs, "output", out->sidecar);
    }
    code = code ? code : rows_files_init(&out->rows, arguments, settings->answer.output, out->format);
    for (size_t i = 0; i < out->rows.count; i++) {
        outputs_add_sidecar(&out->outputs, out->rows.items[i].kind->option, out->rows.items[i].sidecar);
    }
    return code || outputs_differ(&out->outputs) ? code : EXIT_USAGE;
}

void request_finish(struct request *request)
{
    for (size_t i = 0; request->answerers && i < request->atlases.count; i++) {
        conus_report_destroy(request->answerers[i].report);
        conus_pose_check_destroy(request->answerers[i].aims);
        conus_selector_destroy(request->answerers[i].selector);
    }
    free(request->answerers);
    rows_files_finish(&request->rows);
    conus_pose_stream_destroy(request->stream);
    conus_pose_list_destroy(request->poses);
    atlases_finish(&request->atlases);
    named_places_finish(&request->places);
    free(request->scalp[0]);
    free(request->scalp[1]);
    free(request->command_line);
    free(request->sidecar);
}

static const char *coordinates_of(const struct request *request)
{
    return (request->poses ? conus_pose_list_facts(request->poses) : conus_pose_stream_facts(request->stream))
        .coordsystem;
}

int request_check_outputs(const struct request *request)
{
    if (!outputs_differ(&request->outputs) || !outputs_spare_inputs(&request->outputs)) {
        return EXIT_USAGE;
    }
    int code = answer_check_names(request->format, &request->outputs, request->arguments, &request->atlases);
    return code ? code : outputs_check(&request->outputs, request->settings->answer.force);
}

void request_list_inputs(struct provenance *out, const struct request *request)
{
    const struct request_settings *settings = request->settings;
    out->question = (struct question){request->arguments, "answers", settings->engine.radius > 0 ? "cylinder" : "cone"};
    out->is_table = format_is(request->format, "table");
    provenance_add_input(out, settings->aim.pose);
    provenance_add_input(out, coordinates_of(request));
    provenance_add_input(out, settings_level_file(&settings->engine));
    provenance_add_input(out, request->scalp[0]);
    provenance_add_input(out, request->scalp[1]);
    provenance_add_input(out, settings->engine.weight_file[0]);
    provenance_add_input(out, settings->engine.weight_file[1]);
}

conus_pose_options request_pose_options(const struct request *request)
{
    const struct request_settings *settings = request->settings;
    const conus_atlas *atlas = request->atlases.count ? request->atlases.items[0].atlas : NULL;
    return pose_settings_options(&settings->file, &settings->aim, &settings->engine, &request->frame, atlas,
                                 settings->atlas.max_memory);
}

int request_load_poses(struct request *request)
{
    const char *path = request->settings->aim.pose;
    if (!path) {
        return EXIT_DONE;
    }
    conus_pose_options options = request_pose_options(request);
    options.all_rows = format_is(request->format, "bids") || format_of(request->format)->is_of_probe;
    if (request->kept) {
        options.keep = request->marks.names = request->kept->at;
        options.keep_count = request->marks.count = request->kept->count;
    }
    conus_status status = conus_pose_list_load(&request->poses, path, &options);
    return status ? pose_settings_print_error(status, path, "pose", request->arguments) : EXIT_DONE;
}

int request_load_atlases(struct request *request)
{
    const struct request_settings *settings = request->settings;
    struct atlas_settings atlas = settings->atlas;
    atlas.answers = !settings->aim.inward; /* which may take the head of a context */
    int code = atlases_load(&request->atlases, request->arguments->operands[0], &atlas, &settings->context);
    request->answerers = code ? NULL : calloc(1 + settings->atlas.more.count, sizeof *request->answerers);
    if (!code && !request->answerers) {
        return print_no_memory();
    }
    return code;
}

int request_load(struct request *request, int (*load_poses)(void *user), void *user)
{
    const struct request_settings *settings = request->settings;
    const char *name = request->arguments->command->name;
    bool is_of_pose = strcmp(name, "query") == 0 || strcmp(name, "sweep") == 0;
    const char *option = is_of_pose ? "pose" : "poses";
    int code = pose_settings_check_file(settings->aim.pose, option, request->arguments);
    code = code ? code : request_load_atlases(request); /* whose size tells centimetres from millimetres */
    code = code
               ? code
               : space_settings_frame(&request->frame, &request->atlases, &settings->aim.space, settings->common.quiet);
    code = code ? code : settings_scalp(&request->places.scalp, request->scalp, &settings->aim, &request->frame);
    code = code ? code
                : settings_scalp_match(request->places.scalp, &request->atlases, settings->file.any_space,
                                       settings->common.quiet);
    return code ? code : load_poses ? load_poses(user) : request_load_poses(request);
}

int request_match(struct request *request)
{
    const struct request_settings *settings = request->settings;
    const char *path = settings->aim.pose;
    if (request->poses) {
        int code =
            pose_settings_match_list(request->poses, path, &request->atlases, &settings->file, &settings->common);
        if (!code) {
            pose_settings_warn_of_names(request->poses, path, &request->atlases);
        }
        return code ? code : pose_settings_mark_list(&request->marks, request->poses);
    }
    return request->stream ? pose_settings_match_stream(&request->notes_said, request->stream, path, &request->atlases,
                                                        &settings->file, &settings->common)
                           : EXIT_DONE;
}

int request_find_aim(struct request *request)
{
    const struct aim_settings *aim = &request->settings->aim;
    request->places.atlas = request->atlases.items[0].atlas;
    request->places.frame = &request->frame;
    settings_say_handle(request->arguments, &request->settings->engine, &request->settings->common);
    return aim->origin || aim->focus
               ? settings_pose(&request->aim, &request->aim_target, &request->places, aim, request->arguments)
               : EXIT_DONE;
}

conus_status request_start(struct request *request, const conus_selector_options *options)
{
    conus_selector_options own = *options;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        struct answerer *answerer = &request->answerers[i];
        own.level = i ? NULL : options->level;
        own.frame = &request->frame;
        status = conus_selector_create(&answerer->selector, request->atlases.items[i].atlas, &own);
        status = status ? status : conus_pose_check_create(&answerer->aims, answerer->selector);
    }
    if (!status && request->settings->common.verbose) {
        print_error_line("engine: %s", conus_selector_engine(request->answerers[0].selector));
    }
    return status;
}

conus_report_options request_report_options(const struct request *request)
{
    return (conus_report_options){.format = request->format,
                                  .frame = &request->frame,
                                  .command = request->command_line,
                                  .places = request->places.items,
                                  .place_count = request->places.count,
                                  .marks = request->poses ? &request->marks : NULL};
}

conus_status request_report(struct request *request, size_t index, const conus_report_options *options)
{
    struct answerer *answerer = &request->answerers[index];
    conus_report_options own = *options;
    own.atlas = request->atlases.items[index].name;
    conus_status status = conus_report_create(&answerer->report, answerer->selector, &own);
    status = status || index == 0 ? status : conus_report_join(request->answerers[0].report, answerer->report);
    return status ? status : rows_files_report(&request->rows, answerer->selector, &own);
}

conus_status request_reports(struct request *request, const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        status = request_report(request, i, options);
    }
    return status;
}

int request_start_without_rays(struct request *request, const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        const conus_selector_options selector = {
            .level = i ? NULL : request->settings->engine.level, .frame = &request->frame, .engine = CONUS_ENGINE_RAYS};
        status = conus_selector_create(&request->answerers[i].selector, request->atlases.items[i].atlas, &selector);
        status = status ? status : request_report(request, i, options);
    }
    return print_status(status);
}

void request_count_pose(struct request *request, size_t line, const conus_pose *pose, double angle)
{
    for (size_t i = 0; i < request->atlases.count && request->settings->aim.aperture == 0;
         i++) { /* beams begin inside */
        conus_pose_check_add(request->answerers[i].aims, line, pose, angle);
    }
}

void request_count_point(struct request *request, size_t line, const double point[3], double radius)
{
    for (size_t i = 0; i < request->atlases.count; i++) {
        conus_pose_check_add_point(request->answerers[i].aims, line, point, radius);
    }
}

double request_angle(const struct request *request, const conus_pose_row *row)
{
    return row->angle != 0 ? row->angle : settings_angle(&request->settings->aim, &request->settings->engine);
}

void request_start_progress(struct request *request, size_t rows)
{
    progress_start(&request->progress, PROGRESS_AUTO, request->settings->common.quiet,
                   request->steps ? "samples" : "poses", rows * (request->steps ? request->steps : 1));
}

void request_show_step(struct request *request, size_t done)
{
    progress_update(&request->progress, request->row * (request->steps ? request->steps : 1) + done, 0);
}

void request_mark(struct request *request, size_t index, const conus_pose_row *row)
{
    request->marks.number = index + 1;
    request->marks.time_s = row->error ? NAN : row->time_s;
    request->marks.texts = row->kept;
}

int request_each_row(struct request *request, int (*answer)(void *user, const conus_pose_row *row), void *user)
{
    int code = EXIT_DONE;
    size_t count = conus_pose_list_count(request->poses);
    if (!count) {
        pose_settings_say_none(request->settings->aim.pose, &request->settings->common);
    }
    request_start_progress(request, count);
    for (size_t i = 0; !code && i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(request->poses, i);
        request->row = i;
        request_mark(request, i, row);
        code = answer(user, row);
        request_show_step(request, request->steps ? request->steps : 1);
    }
    progress_finish(&request->progress, 0, 0);
    return code;
}

int request_skip_row(struct request *request, const conus_pose_row *row, const char *why)
{
    const char *path = request->rows_of ? request->rows_of : request->settings->aim.pose;
    print_error_line("%s:%zu: %s", pose_settings_file_name(path), row->line, why);
    request->failed = true;
    return EXIT_DONE;
}

int request_refuse_row(struct request *request, const conus_pose_row *row, const char *why)
{
    request_skip_row(request, row, why);
    conus_status status = rows_files_refuse(&request->rows, row->id, row->line, why);
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        status = conus_report_add_error(request->answerers[i].report, row->id, row->line, why);
    }
    return print_status(status);
}

void request_say_notes(const struct request *request)
{
    atlases_say_notes(&request->atlases, &request->settings->common);
    atlases_say_spaces(&request->atlases, &request->settings->common);
    if (!format_is(request->format, "table") && !request->settings->common.quiet) {
        named_places_say(&request->places); /* which has them in its head */
    }
}

void request_say_aims(const struct request *request)
{
    const char *path = request->rows_of ? request->rows_of : request->settings->aim.pose;
    size_t count = request->atlases.count;
    struct aimed *aimed = calloc(count, sizeof *aimed);
    for (size_t i = 0; aimed && i < count; i++) {
        const struct named_atlas *at = &request->atlases.items[i];
        const struct answerer *answerer = &request->answerers[i];
        conus_pose_findings found = *conus_pose_check_found(answerer->aims);
        if (found.away.count && answerer->empty.count == found.poses) { /* in the box or not, none hits */
            found.away = answerer->empty;
        }
        aimed[i] = (struct aimed){found,
                                  answerer->selector,
                                  at->atlas,
                                  at->name,
                                  &request->frame,
                                  false,
                                  settings_point_radius(&request->settings->engine, NULL,
                                                        request->rows_of || format_of(request->format)->is_foreign)};
    }
    if (aimed) {
        aim_notes_say(aimed, count, path ? pose_settings_file_name(path) : NULL, &request->settings->common);
    }
    free(aimed);
}

int request_write_answer(const struct request *request, struct provenance *provenance)
{
    provenance_add_outputs(provenance, request->arguments);
    return request->rows.replace ? EXIT_DONE
                                 : answer_write(request->answerers[0].report, request->settings->answer.output,
                                                request->sidecar, provenance);
}

int request_code(const struct request *request, int code)
{
    return code ? code : request->failed ? EXIT_DIFFERENT : EXIT_DONE;
}
