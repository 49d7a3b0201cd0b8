/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps that query, sweep and track share: checks, loading, matching, rows without an answer, notes. */
#include "cli/inquiry.h"

#include "options/messages.h"
#include "options/output.h"
#include "settings/notes.h"

#include <assert.h>
#include <stdlib.h>

const struct option inquiry_level_options[] = {
    {.name = "level",
     .type = OPTION_TEXT,
     .offset = INQUIRY_FIELD(engine.level),
     .value = "LEVEL",
     .help = "report areas at this depth of the area tree (1 = its roots), or as these areas: names, @FILE",
     .words = "hierarchy, ontology",
     .common = true,
     .role = OPTION_READS},
    {0},
};

bool inquiry_check(const struct inquiry_settings *settings, const struct arguments *arguments, bool has_history)
{
    return settings_check_score(&settings->engine, has_history) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) &&
           settings_check_space(arguments, &settings->aim.space);
}

int inquiry_init(struct inquiry *out, const struct inquiry_settings *settings, const struct arguments *arguments)
{
    *out = (struct inquiry){.settings = settings, .arguments = arguments};
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
    return code;
}

void inquiry_finish(struct inquiry *inquiry)
{
    for (size_t i = 0; inquiry->answerers && i < inquiry->atlases.count; i++) {
        conus_report_destroy(inquiry->answerers[i].report);
        conus_aims_destroy(inquiry->answerers[i].aims);
        conus_selector_destroy(inquiry->answerers[i].selector);
    }
    free(inquiry->answerers);
    conus_pose_stream_destroy(inquiry->stream);
    conus_pose_list_destroy(inquiry->poses);
    atlases_finish(&inquiry->atlases);
    free(inquiry->command_line);
    free(inquiry->sidecar);
}

static const char *coordinates_of(const struct inquiry *inquiry)
{
    return inquiry->poses ? conus_pose_list_coordsystem(inquiry->poses)
                          : conus_pose_stream_coordsystem(inquiry->stream);
}

/* Whether no output is a file that is read; prints an error if one is. */
static bool check_inputs(const struct inquiry *inquiry, const char *matrix)
{
    const struct inquiry_settings *settings = inquiry->settings;
    const struct input inputs[] = {{"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->aim.pose},
                                   {"the coordinate system", coordinates_of(inquiry)},
                                   {"the tracker's matrix", matrix},
                                   {0}};
    for (size_t i = 0; i < inquiry->outputs.count; i++) {
        const struct output *output = &inquiry->outputs.items[i];
        const char *input = atlases_input(&inquiry->atlases, inputs, output->path);
        if (input) {
            print_error_line("%s would overwrite %s %s", output->what, input, output->path);
            return false;
        }
    }
    return true;
}

int inquiry_check_outputs(const struct inquiry *inquiry, const char *matrix)
{
    bool fits = outputs_differ(&inquiry->outputs) && check_inputs(inquiry, matrix);
    int code = fits ? answer_check_names(inquiry->format, &inquiry->outputs, inquiry->arguments, &inquiry->atlases)
                    : EXIT_USAGE;
    return code ? code : outputs_check(&inquiry->outputs, inquiry->settings->answer.force);
}

void inquiry_list_inputs(struct provenance *out, const struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    out->question = (struct question){inquiry->arguments, "answers", settings->engine.radius > 0 ? "cylinder" : "cone"};
    provenance_add_input(out, settings->aim.pose);
    provenance_add_input(out, coordinates_of(inquiry));
    provenance_add_input(out, settings_level_file(&settings->engine));
}

conus_pose_options inquiry_pose_options(const struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    return settings_pose_options(&settings->file, &inquiry->frame, settings->atlas.max_memory);
}

int inquiry_load_poses(struct inquiry *inquiry)
{
    const char *path = inquiry->settings->aim.pose;
    const conus_pose_options options = inquiry_pose_options(inquiry);
    conus_status status = path ? conus_pose_list_load(&inquiry->poses, path, &options) : CONUS_OK;
    return status ? settings_print_poses_error(status, path, "pose", inquiry->arguments) : EXIT_DONE;
}

int inquiry_load_atlases(struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    struct atlases *atlases = &inquiry->atlases;
    int code = atlases_load(atlases, inquiry->arguments->operands[0], &settings->atlas);
    for (size_t i = 0; i < atlases->count && !code; i++) {
        code = settings_load_context(atlases->items[i].atlas, settings->context.path, settings->context.blocks,
                                     &settings->atlas);
    }
    inquiry->answerers = code ? NULL : calloc(1 + settings->atlas.more.count, sizeof *inquiry->answerers);
    if (!code && !inquiry->answerers) {
        return print_no_memory();
    }
    return code;
}

int inquiry_load(struct inquiry *inquiry, int (*load_poses)(void *user), void *user)
{
    const struct space_settings *space = &inquiry->settings->aim.space;
    if (settings_space_needs_atlas(space)) {
        int code = inquiry_load_atlases(inquiry);
        code = code ? code : settings_frame(&inquiry->frame, &inquiry->atlases, space, inquiry->settings->common.quiet);
        return code ? code : load_poses(user);
    }
    int code = settings_frame(&inquiry->frame, &inquiry->atlases, space, inquiry->settings->common.quiet);
    code = code ? code : load_poses(user);
    return code ? code : inquiry_load_atlases(inquiry);
}

int inquiry_match(struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    const char *path = settings->aim.pose;
    if (inquiry->poses) {
        return settings_match_poses(inquiry->poses, path, &inquiry->atlases, &settings->file, &settings->common);
    }
    return inquiry->stream
               ? settings_match_stream(inquiry->stream, path, &inquiry->atlases, &settings->file, &settings->common)
               : EXIT_DONE;
}

conus_status inquiry_start(struct inquiry *inquiry, const conus_selector_options *options)
{
    conus_selector_options own = *options;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < inquiry->atlases.count && !status; i++) {
        struct answerer *answerer = &inquiry->answerers[i];
        own.level = i ? NULL : options->level;
        status = conus_selector_create(&answerer->selector, inquiry->atlases.items[i].atlas, &own);
        status = status ? status : conus_aims_create(&answerer->aims, answerer->selector);
    }
    if (!status && inquiry->settings->common.verbose) {
        print_error_line("engine: %s", conus_selector_engine(inquiry->answerers[0].selector));
    }
    return status;
}

conus_report_options inquiry_report_options(const struct inquiry *inquiry)
{
    return (conus_report_options){
        .format = inquiry->format, .frame = &inquiry->frame, .command = inquiry->command_line};
}

conus_status inquiry_report(struct inquiry *inquiry, size_t index, const conus_report_options *options)
{
    struct answerer *answerer = &inquiry->answerers[index];
    conus_report_options own = *options;
    own.atlas = inquiry->atlases.items[index].name;
    conus_status status = conus_report_create(&answerer->report, answerer->selector, &own);
    return status || index == 0 ? status : conus_report_join(inquiry->answerers[0].report, answerer->report);
}

conus_status inquiry_reports(struct inquiry *inquiry, const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < inquiry->atlases.count && !status; i++) {
        status = inquiry_report(inquiry, i, options);
    }
    return status;
}

int inquiry_start_without_rays(struct inquiry *inquiry, const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < inquiry->atlases.count && !status; i++) {
        const conus_selector_options selector = {.level = i ? NULL : inquiry->settings->engine.level,
                                                 .engine = CONUS_ENGINE_RAYS};
        status = conus_selector_create(&inquiry->answerers[i].selector, inquiry->atlases.items[i].atlas, &selector);
        status = status ? status : inquiry_report(inquiry, i, options);
    }
    return status ? print_status(status) : EXIT_DONE;
}

void inquiry_count_pose(struct inquiry *inquiry, size_t line, const conus_pose *pose, double angle)
{
    for (size_t i = 0; i < inquiry->atlases.count; i++) {
        conus_aims_add(inquiry->answerers[i].aims, line, pose, angle);
    }
}

void inquiry_count_point(struct inquiry *inquiry, size_t line, const double point[3], double radius)
{
    for (size_t i = 0; i < inquiry->atlases.count; i++) {
        conus_aims_add_point(inquiry->answerers[i].aims, line, point, radius);
    }
}

double inquiry_angle(const struct inquiry *inquiry, const conus_pose_row *row)
{
    return row->angle != 0 ? row->angle : settings_angle(&inquiry->settings->aim, &inquiry->settings->engine);
}

void inquiry_start_progress(struct inquiry *inquiry, size_t rows)
{
    progress_start(&inquiry->progress, PROGRESS_AUTO, inquiry->settings->common.quiet,
                   inquiry->steps ? "samples" : "poses", rows * (inquiry->steps ? inquiry->steps : 1));
}

void inquiry_show_step(struct inquiry *inquiry, size_t done)
{
    progress_update(&inquiry->progress, inquiry->row * (inquiry->steps ? inquiry->steps : 1) + done, 0);
}

int inquiry_each_row(struct inquiry *inquiry, int (*answer)(void *user, const conus_pose_row *row), void *user)
{
    int code = EXIT_DONE;
    size_t count = conus_pose_list_count(inquiry->poses);
    if (!count) {
        settings_say_no_poses(inquiry->settings->aim.pose, &inquiry->settings->common);
    }
    inquiry_start_progress(inquiry, count);
    for (size_t i = 0; !code && i < count; i++) {
        inquiry->row = i;
        code = answer(user, conus_pose_list_row(inquiry->poses, i));
        inquiry_show_step(inquiry, inquiry->steps ? inquiry->steps : 1);
    }
    progress_finish(&inquiry->progress, 0, 0);
    return code;
}

int inquiry_skip_row(struct inquiry *inquiry, const conus_pose_row *row, const char *why)
{
    print_error_line("%s:%zu: %s", settings_poses_name(inquiry->settings->aim.pose), row->line, why);
    inquiry->failed = true;
    return EXIT_DONE;
}

int inquiry_refuse_row(struct inquiry *inquiry, const conus_pose_row *row, const char *why)
{
    conus_status status = CONUS_OK;
    inquiry_skip_row(inquiry, row, why);
    for (size_t i = 0; i < inquiry->atlases.count && !status; i++) {
        status = conus_report_add_error(inquiry->answerers[i].report, row->id, row->line, why);
    }
    return status ? print_status(status) : EXIT_DONE;
}

void inquiry_say_notes(const struct inquiry *inquiry)
{
    atlases_say_notes(&inquiry->atlases, &inquiry->settings->common);
    atlases_say_spaces(&inquiry->atlases, &inquiry->settings->common);
}

void inquiry_say_aims(const struct inquiry *inquiry)
{
    const char *path = inquiry->settings->aim.pose;
    size_t count = inquiry->atlases.count;
    struct aimed *aimed = calloc(count, sizeof *aimed);
    for (size_t i = 0; aimed && i < count; i++) {
        const struct named_atlas *at = &inquiry->atlases.items[i];
        const struct answerer *answerer = &inquiry->answerers[i];
        aimed[i] =
            (struct aimed){conus_aims_found(answerer->aims), answerer->selector, at->atlas, at->name, &inquiry->frame};
    }
    if (aimed) {
        aim_notes_say(aimed, count, path ? settings_poses_name(path) : NULL, &inquiry->settings->common);
    }
    free(aimed);
}

int inquiry_code(const struct inquiry *inquiry, int code)
{
    return code ? code : inquiry->failed ? EXIT_DIFFERENT : EXIT_DONE;
}
