/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps that query, sweep and track share: checks, loading, matching, rows without an answer, notes. */
#include "cli/inquiry.h"

#include "common/messages.h"
#include "common/output.h"
#include "settings/aim_notes.h"
#include "settings/atlas_input.h"
#include "settings/atlas_notes.h"

#include <stdlib.h>

bool inquiry_check(const struct inquiry_settings *settings, const struct arguments *arguments, bool has_history)
{
    if (!settings_check_slices(&settings->engine, arguments, "slices") ||
        !settings_check_slices(&settings->engine, arguments, "slice-fraction")) {
        return false;
    }
    return settings_check_score(&settings->engine, has_history) && settings_check_context(arguments) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments);
}

void inquiry_add_output(struct inquiry *inquiry, const char *what, const char *path)
{
    inquiry->outputs[inquiry->output_count++] = (struct output){what, path};
}

int inquiry_init(struct inquiry *out, const struct inquiry_settings *settings, const struct arguments *arguments)
{
    const char *output = settings->answer.output;
    *out = (struct inquiry){.settings = settings, .arguments = arguments};
    if (!answer_format(&out->format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    out->command_line = arguments_text(arguments);
    if (!out->command_line || !answer_sidecar(&out->sidecar, out->format, output)) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    inquiry_add_output(out, "--output", output_is_stdout(output) ? NULL : output);
    inquiry_add_output(out, "the .json beside --output", out->sidecar);
    return EXIT_DONE;
}

void inquiry_finish(struct inquiry *inquiry)
{
    conus_report_destroy(inquiry->report);
    conus_aims_destroy(inquiry->aims);
    conus_selector_destroy(inquiry->selector);
    conus_pose_stream_destroy(inquiry->stream);
    conus_pose_list_destroy(inquiry->poses);
    conus_atlas_destroy(inquiry->atlas);
    free(inquiry->command_line);
    free(inquiry->sidecar);
}

bool inquiry_check_outputs(const struct inquiry *inquiry)
{
    for (size_t i = 0; i < inquiry->output_count; i++) {
        const struct output *one = &inquiry->outputs[i];
        for (size_t j = 0; one->path && j < i; j++) {
            const struct output *other = &inquiry->outputs[j];
            if (other->path && paths_equal(one->path, other->path)) {
                print_error_line("%s and %s are the same file %s", other->what, one->what, one->path);
                return false;
            }
        }
    }
    return true;
}

bool inquiry_check_inputs(const struct inquiry *inquiry, const char *matrix)
{
    const struct inquiry_settings *settings = inquiry->settings;
    const char *coordinates =
        inquiry->poses ? conus_pose_list_coordsystem(inquiry->poses) : conus_pose_stream_coordsystem(inquiry->stream);
    const struct input inputs[] = {{"the atlas", inquiry->arguments->operands[0]},
                                   {"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->aim.pose},
                                   {"the coordinate system", coordinates},
                                   {"the tracker's matrix", matrix},
                                   {0}};
    for (size_t i = 0; i < inquiry->output_count; i++) {
        const struct output *output = &inquiry->outputs[i];
        const char *input = output->path ? settings_input(inquiry->atlas, inputs, output->path) : NULL;
        if (input) {
            print_error_line("%s would overwrite %s %s", output->what, input, output->path);
            return false;
        }
    }
    return true;
}

conus_pose_options inquiry_pose_options(const struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    return settings_pose_options(&settings->file, settings->aim.space, settings->atlas.max_memory);
}

int inquiry_load_poses(struct inquiry *inquiry)
{
    const char *path = inquiry->settings->aim.pose;
    const conus_pose_options options = inquiry_pose_options(inquiry);
    conus_status status = path ? conus_pose_list_load(&inquiry->poses, path, &options) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
}

int inquiry_load_atlas(struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    int code = settings_load_atlas(&inquiry->atlas, inquiry->arguments->operands[0], &settings->atlas);
    return code ? code
                : settings_load_context(inquiry->atlas, settings->context.path, settings->context.blocks,
                                        &settings->atlas);
}

int inquiry_match(struct inquiry *inquiry)
{
    const struct inquiry_settings *settings = inquiry->settings;
    const char *path = settings->aim.pose;
    if (inquiry->poses) {
        return settings_match_poses(inquiry->poses, path, inquiry->atlas, &settings->file, &settings->common);
    }
    return inquiry->stream
               ? settings_match_stream(inquiry->stream, path, inquiry->atlas, &settings->file, &settings->common)
               : EXIT_DONE;
}

conus_status inquiry_start(struct inquiry *inquiry, const conus_selector_options *options)
{
    conus_status status = conus_selector_create(&inquiry->selector, inquiry->atlas, options);
    status = status ? status : conus_aims_create(&inquiry->aims, inquiry->selector);
    if (!status && inquiry->settings->common.verbose) {
        print_error_line("engine: %s", conus_selector_engine(inquiry->selector));
    }
    return status;
}

conus_report_options inquiry_report_options(const struct inquiry *inquiry)
{
    return (conus_report_options){.format = inquiry->format,
                                  .space = (conus_space)inquiry->settings->aim.space,
                                  .command = inquiry->command_line};
}

double inquiry_angle(const struct inquiry *inquiry, const conus_pose_row *row)
{
    return row->angle != 0 ? row->angle : settings_angle(&inquiry->settings->aim, &inquiry->settings->engine);
}

int inquiry_each_row(struct inquiry *inquiry, int (*answer)(void *user, const conus_pose_row *row), void *user)
{
    int code = EXIT_DONE;
    size_t count = conus_pose_list_count(inquiry->poses);
    if (!count) {
        settings_say_no_poses(inquiry->settings->aim.pose, &inquiry->settings->common);
    }
    for (size_t i = 0; !code && i < count; i++) {
        code = answer(user, conus_pose_list_row(inquiry->poses, i));
    }
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
    inquiry_skip_row(inquiry, row, why);
    conus_status status = conus_report_add_error(inquiry->report, row->id, row->line, why);
    return status ? print_status(status) : EXIT_DONE;
}

void inquiry_say_notes(const struct inquiry *inquiry)
{
    settings_say_notes(inquiry->atlas, &inquiry->settings->common);
}

void inquiry_say_aims(const struct inquiry *inquiry)
{
    const char *path = inquiry->settings->aim.pose;
    aim_notes_say(conus_aims_found(inquiry->aims), inquiry->selector, inquiry->atlas,
                  path ? settings_poses_name(path) : NULL, &inquiry->settings->common);
}

int inquiry_code(const struct inquiry *inquiry, int code)
{
    return code ? code : inquiry->failed ? EXIT_DIFFERENT : EXIT_DONE;
}
