/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/commands.h"
#include "cli/mask.h"
#include "common/aim_notes.h"
#include "common/answer_format.h"
#include "common/messages.h"
#include "common/output.h"
#include "common/pose_settings.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct query_settings {
    struct atlas_settings atlas;
    struct aim_settings aim;
    struct pose_file_settings file;
    struct engine_settings engine;
    struct common_settings common;
    struct context_settings context;
    struct answer_settings answer;
    const char *voxels;
    size_t voxels_of;
    const char *image;
    const char *deep;
    struct mask_settings mask;
    double point[3];
};

static const char *const voxel_kinds[] = {"pathways", "all", NULL};

static const struct option point_options[] = {
    {.name = "point",
     .type = OPTION_VECTOR,
     .offset = offsetof(struct query_settings, point),
     .value = "X,Y,Z",
     .help = "instead of a cone: what is at this point and within --radius MM of it"},
    {0},
};

static const struct option output_options[] = {
    {.name = "voxels",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, voxels),
     .value = "FILE.tsv",
     .help = "write the voxels met first, or with --layers all and --point those in the cone or ball, with indices, "
             "positions and values"},
    {.name = "voxels-of",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct query_settings, voxels_of),
     .value = "KIND",
     .help = "whose voxels:",
     .choices = voxel_kinds},
    {.name = "image",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, image),
     .value = "FILE",
     .help = "write what the device saw: .exr with id, X, Y, Z, t per pixel, or .png in the areas' colours"},
    {.name = "deep",
     .type = OPTION_TEXT,
     .offset = offsetof(struct query_settings, deep),
     .value = "FILE.exr",
     .help = "with --layers all: write every piece of every ray inside an object, as a deep image with names"},
    {0},
};

static const struct option_group groups[] = {
    {"Where the cone is", aim_options, offsetof(struct query_settings, aim)},
    {"", pose_file_options, offsetof(struct query_settings, file)},
    {"", angle_options, offsetof(struct query_settings, aim)},
    {"", shape_options, offsetof(struct query_settings, engine)},
    {"", point_options, 0},
    {"How it looks", engine_options, offsetof(struct query_settings, engine)},
    {"", slices_options, offsetof(struct query_settings, engine)},
    {"What it may find", atlas_options, offsetof(struct query_settings, atlas)},
    {"", shown_options, offsetof(struct query_settings, atlas)},
    {"", context_options, offsetof(struct query_settings, context)},
    {"What is written", query_answer_options, offsetof(struct query_settings, answer)},
    {"", output_options, 0},
    {"", mask_options, offsetof(struct query_settings, mask)},
    {"", quiet_options, offsetof(struct query_settings, common)},
    {0},
};

enum { OUTPUT_COUNT = 7 };

/** A query under way. */
struct query {
    const struct query_settings *settings;
    const struct arguments *arguments;
    conus_format format;
    char *command_line;
    char *sidecar; /* path, NULL if there is none to write */
    struct output {
        const char *what, *path;
    } outputs[OUTPUT_COUNT];
    conus_atlas *atlas;
    conus_pose_list *poses;
    conus_selector *selector;
    conus_aims *aims;
    conus_report *report;
    conus_image *image;
    struct mask mask;
    conus_selection *selection; /* kept for --deep */
    bool failed;                /* some poses had no answer */
};

static void query_finish(struct query *query)
{
    conus_image_destroy(query->image);
    mask_finish(&query->mask);
    conus_selection_destroy(query->selection);
    conus_report_destroy(query->report);
    conus_aims_destroy(query->aims);
    conus_selector_destroy(query->selector);
    conus_pose_list_destroy(query->poses);
    conus_atlas_destroy(query->atlas);
    free(query->command_line);
    free(query->sidecar);
}

static bool check_outputs(const struct query_settings *settings, const struct arguments *arguments)
{
    conus_format format;
    if (settings->voxels && output_format(&format, settings->voxels) && format != CONUS_TSV && format != CONUS_TABLE) {
        print_error_line("--voxels: %s ends as what it will not be: TSV is written", settings->voxels);
        return false;
    }
    if (!option_needs(arguments, "voxels-of", "voxels")) {
        return false;
    }
    if (settings->image && !path_ends(settings->image, ".exr") && !path_ends(settings->image, ".png")) {
        print_error_line("--image: \"%s\" ends neither in .exr nor in .png", settings->image);
        return false;
    }
    if (settings->deep && !path_ends(settings->deep, ".exr")) {
        print_error_line("--deep: \"%s\" does not end in .exr", settings->deep);
        return false;
    }
    if (settings->deep && settings->engine.layers != CONUS_ALL_LAYERS) {
        print_error_line("--deep needs --layers all");
        return false;
    }
    return mask_check(&settings->mask, arguments);
}

/* What each format of another program is made of. */
static bool check_format(conus_format format, const struct query_settings *settings)
{
    bool of_contacts = format == CONUS_BIDS || format == CONUS_SPIKEGLX || format == CONUS_OPEN_EPHYS;
    if (of_contacts && !settings->aim.pose) {
        print_error_line("--format: this one is of contacts, --pose FILE names them");
        return false;
    }
    return true;
}

/* A ball has a point and a radius, and nothing that is only of cones. */
static bool check_point(const struct arguments *arguments)
{
    static const char *const of_cones[] = {"origin", "toward",   "direction", "up",         "pose",     "angle",
                                           "layers", "range",    "engine",    "resolution", "aperture", "score",
                                           "slices", "sampling", "context",   "image",      "deep"};
    for (size_t i = 0; i < sizeof of_cones / sizeof of_cones[0]; i++) {
        if (!options_exclude(arguments, "point", of_cones[i])) {
            return false;
        }
    }
    return option_needs(arguments, "point", "radius");
}

static bool check(const struct query_settings *settings, const struct arguments *arguments)
{
    if (option_given(arguments, "point")) {
        return check_point(arguments) && check_outputs(settings, arguments);
    }
    if (option_given(arguments, "slices") && settings->engine.sampling != CONUS_SLICES) {
        print_error_line("--slices has no effect without --sampling slices");
        return false;
    }
    return settings_check_score(&settings->engine, false) && settings_check_context(arguments) &&
           settings_check_aim(arguments, true) && settings_check_pose_file(arguments, "pose", NULL) &&
           settings_check_shape(&settings->aim, &settings->engine, arguments) && check_outputs(settings, arguments);
}

static int load_poses(struct query *query)
{
    const struct aim_settings *aim = &query->settings->aim;
    const conus_pose_options options =
        settings_pose_options(&query->settings->file, aim->space, query->settings->atlas.max_memory);
    conus_status status = conus_pose_list_load(&query->poses, aim->pose, &options);
    if (status) {
        return print_status(status);
    }
    size_t count = conus_pose_list_count(query->poses);
    const char *of_one = query->settings->image       ? "image"
                         : query->settings->deep      ? "deep"
                         : query->settings->mask.path ? "mask"
                                                      : NULL;
    if (of_one && count != 1) {
        return print_usage_error("--%s shows one pose, %s has %zu", of_one, settings_poses_name(aim->pose), count);
    }
    for (size_t i = 0; i < count && aim->angle != 0; i++) {
        if (conus_pose_list_row(query->poses, i)->angle == 0) {
            return EXIT_DONE;
        }
    }
    return count && aim->angle != 0 ? print_usage_error("--angle has no effect: every pose in %s has its own",
                                                        settings_poses_name(aim->pose))
                                    : EXIT_DONE;
}

/* A pose without an answer has a row that says why. */
static int refuse(struct query *query, const conus_pose_row *row, const char *reason)
{
    print_error_line("%s:%zu: %s", settings_poses_name(query->settings->aim.pose), row->line, reason);
    query->failed = true;
    conus_status status = conus_report_add_error(query->report, row->id, row->line, reason);
    return status ? print_status(status) : EXIT_DONE;
}

/* Adds the answer to the report and to what else is written. The image is of the last one. */
static int take(struct query *query, const char *id, conus_selection *selection)
{
    conus_status status = conus_report_add(query->report, id, selection);
    if (!status && query->settings->image) {
        status = conus_image_of_selection(&query->image, selection);
    }
    int code = status ? print_status(status) : mask_take(&query->mask, query->atlas, selection);
    if (!code && query->settings->deep) {
        query->selection = selection;
    } else {
        conus_selection_destroy(selection);
    }
    return code;
}

static int answer_row(struct query *query, const conus_pose_row *row)
{
    const struct aim_settings *aim = &query->settings->aim;
    const struct engine_settings *engine = &query->settings->engine;
    conus_selection *selection = NULL;
    conus_status status = CONUS_OK;
    bool ball = row->is_point && engine->radius > 0;
    if (row->error || (row->is_point && !ball)) {
        return refuse(query, row, row->error ? row->error : POINT_LOOKS_NOWHERE);
    }
    if (ball) {
        status = conus_select_ball(&selection, query->selector, row->pose.world_from_device + 12, engine->radius);
    } else {
        double angle = row->angle != 0 ? row->angle : settings_angle(aim, engine);
        status = conus_select(&selection, query->selector, &row->pose, angle);
        conus_aims_add(query->aims, row->line, &row->pose, angle);
    }
    if (status == CONUS_ERROR_ARGUMENT) {
        return refuse(query, row, conus_message());
    }
    return status ? print_status(status) : take(query, row->id, selection);
}

static int answer_one(struct query *query)
{
    const struct query_settings *settings = query->settings;
    conus_selection *selection = NULL;
    conus_pose pose;
    conus_status status;
    if (option_given(query->arguments, "point")) {
        double point[3];
        settings_point(point, settings->point, settings->aim.space);
        status = conus_select_ball(&selection, query->selector, point, settings->engine.radius);
        return status ? print_status(status) : take(query, "1", selection);
    }
    int code = settings_pose(&pose, &settings->aim, query->arguments);
    if (code) {
        return code;
    }
    double angle = settings_angle(&settings->aim, &settings->engine);
    status = conus_select(&selection, query->selector, &pose, angle);
    conus_aims_add(query->aims, 1, &pose, angle);
    return status ? print_status(status) : take(query, "1", selection);
}

static int answer_all(struct query *query)
{
    if (!query->poses) {
        return answer_one(query);
    }
    int code = EXIT_DONE;
    if (!conus_pose_list_count(query->poses)) {
        settings_say_no_poses(query->settings->aim.pose, &query->settings->common);
    }
    for (size_t i = 0; !code && i < conus_pose_list_count(query->poses); i++) {
        code = answer_row(query, conus_pose_list_row(query->poses, i));
    }
    return code;
}

static conus_status start(struct query *query)
{
    const struct query_settings *settings = query->settings;
    conus_selector_options engine = settings_engine(&settings->engine, &settings->common);
    if (option_given(query->arguments, "point")) {
        engine.radius = 0; /* of the ball */
        engine.layers = CONUS_ALL_LAYERS;
    }
    conus_status status = conus_selector_create(&query->selector, query->atlas, &engine);
    status = status ? status : conus_aims_create(&query->aims, query->selector);
    if (status) {
        return status;
    }
    if (settings->common.verbose) {
        print_error_line("engine: %s", conus_selector_engine(query->selector));
    }
    const char *electrodes = query->format == CONUS_BIDS ? conus_pose_list_electrodes(query->poses) : NULL;
    const conus_report_options report = {.format = query->format,
                                         .space = (conus_space)settings->aim.space,
                                         .all_voxels = settings->voxels_of == 1,
                                         .no_voxels = !settings->voxels,
                                         .command = query->command_line,
                                         .electrodes = electrodes};
    return conus_report_create(&query->report, query->selector, &report);
}

static int write_sidecar(struct query *query)
{
    return answer_write_sidecar(query->report, query->sidecar);
}

static int write_voxels(struct query *query)
{
    const char *text = NULL;
    size_t size = 0;
    if (!query->settings->voxels) {
        return EXIT_DONE;
    }
    conus_status status = conus_report_voxels(query->report, &text, &size);
    return status ? print_status(status) : output_write(query->settings->voxels, text, size);
}

static int write_image(struct query *query)
{
    if (!query->image) {
        return EXIT_DONE;
    }
    conus_status status = conus_image_write(query->image, query->settings->image);
    return status ? print_status(status) : EXIT_DONE;
}

static int write_answer(struct query *query)
{
    return answer_write(query->report, query->settings->answer.output);
}

static int write_deep(struct query *query)
{
    if (!query->selection) {
        return EXIT_DONE;
    }
    conus_status status = conus_selection_write_deep(query->selection, query->settings->deep);
    return status ? print_status(status) : EXIT_DONE;
}

static int write_mask(struct query *query)
{
    return mask_write(&query->mask, query->report);
}

/* The answer comes last: where it is, all that belongs to it is there, too. */
static int write_all(struct query *query)
{
    static int (*const steps[])(struct query *) = {write_sidecar, write_voxels, write_image,
                                                   write_deep,    write_mask,   write_answer};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        int code = steps[i](query);
        if (code) {
            return code;
        }
    }
    return query->failed ? EXIT_DIFFERENT : EXIT_DONE;
}

/* No two outputs may be one file. */
static bool check_paths(const struct query *query)
{
    for (size_t i = 0; i < OUTPUT_COUNT; i++) {
        const struct output *one = &query->outputs[i];
        for (size_t j = 0; one->path && j < i; j++) {
            const struct output *other = &query->outputs[j];
            if (other->path && paths_equal(one->path, other->path)) {
                print_error_line("%s and %s are the same file %s", other->what, one->what, one->path);
                return false;
            }
        }
    }
    return true;
}

static bool check_inputs(const struct query *query)
{
    const struct query_settings *settings = query->settings;
    const struct input inputs[] = {{"the atlas", query->arguments->operands[0]},
                                   {"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {"the file of poses", settings->aim.pose},
                                   {"the coordinate system", conus_pose_list_coordsystem(query->poses)},
                                   {0}};
    for (size_t i = 0; i < OUTPUT_COUNT; i++) {
        const struct output *output = &query->outputs[i];
        const char *input = output->path ? settings_input(query->atlas, inputs, output->path) : NULL;
        if (input) {
            print_error_line("%s would overwrite %s %s", output->what, input, output->path);
            return false;
        }
    }
    return true;
}

/* Whether --voxels has something to list. */
static bool check_voxels(const struct query *query)
{
    size_t count = conus_atlas_object_count(query->atlas);
    const conus_object *last = conus_atlas_object(query->atlas, count); /* pathways come last */
    if (query->settings->voxels && !query->settings->voxels_of && !(last && last->kind == CONUS_PATHWAY)) {
        print_error_line(
            "--voxels lists the voxels of pathways, and there is none; --pathway adds one, --voxels-of all the areas'");
        return false;
    }
    return true;
}

static int work(struct query *query)
{
    const struct query_settings *settings = query->settings;
    int code = settings->aim.pose ? load_poses(query) : EXIT_DONE;
    code = code
               ? code
               : settings_check_electrodes(query->format, conus_pose_list_electrodes(query->poses), settings->aim.pose);
    if (!code) {
        code = settings_load_atlas(&query->atlas, query->arguments->operands[0], &settings->atlas);
    }
    if (!code) {
        code = settings_load_context(query->atlas, settings->context.path, settings->context.blocks, &settings->atlas);
    }
    if (code) {
        return code;
    }
    if (!check_inputs(query) || !check_voxels(query)) {
        return EXIT_USAGE;
    }
    code = query->poses ? settings_match_poses(query->poses, settings->aim.pose, query->atlas, &settings->file,
                                               &settings->common)
                        : EXIT_DONE;
    if (code) {
        return code;
    }
    conus_status status = start(query);
    code = status ? print_status(status) : answer_all(query);
    if (code) {
        return code;
    }
    settings_say_notes(query->atlas, &settings->common);
    settings_say_open(query->atlas, &settings->engine, &settings->common);
    aim_notes_say(conus_aims_found(query->aims), query->selector, query->atlas,
                  query->poses ? settings_poses_name(settings->aim.pose) : NULL, &settings->common);
    return write_all(query);
}

static int run_named(struct query *query)
{
    const struct query_settings *settings = query->settings;
    const char *answer = output_is_stdout(settings->answer.output) ? NULL : settings->answer.output;
    query->command_line = arguments_text(query->arguments);
    if (!query->command_line || !answer_sidecar(&query->sidecar, query->format, settings->answer.output)) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    if (!mask_init(&query->mask, &settings->mask, query->arguments)) {
        return EXIT_DATA;
    }
    const struct output outputs[OUTPUT_COUNT] = {{"--output", answer},
                                                 {"the .json beside --output", query->sidecar},
                                                 {"--voxels", settings->voxels},
                                                 {"--image", settings->image},
                                                 {"--deep", settings->deep},
                                                 {"--mask", settings->mask.path},
                                                 {"the .json beside --mask", query->mask.sidecar}};
    memcpy(query->outputs, outputs, sizeof outputs);
    return check_format(query->format, settings) && check_paths(query) ? work(query) : EXIT_USAGE;
}

static int run(const void *given, const struct arguments *arguments)
{
    const struct query_settings *settings = given;
    if (!check(settings, arguments)) {
        return EXIT_USAGE;
    }
    struct query query = {.settings = settings, .arguments = arguments};
    if (!answer_format(&query.format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    int code = run_named(&query);
    query_finish(&query);
    return code;
}

const struct command cmd_query = {
    .name = "query",
    .summary = "name the areas and pathways in a cone, with shares and contact positions",
    .operands = {"ATLAS"},
    .form = "(--origin X,Y,Z (--toward X,Y,Z | --direction X,Y,Z) | --pose FILE)",
    .description = "Looks from a device's position through N x N pixels into the atlas and reports every area and\n"
                   "pathway that a pixel of the cone meets first: its share of the cone, its pixels, its nearest\n"
                   "contact and where it is, in mm. With --layers all it reports everything in the cone, occluded or\n"
                   "not; with --point in place of a cone, what is within --radius mm of a point.",
    .examples = "  conus query aal.nii.gz --origin -90,20,20 --toward 0,-10,10 --angle 20\n"
                "  conus query aal.nii.gz --pose poses.tsv --angle 5 -o answers.tsv\n"
                "  conus query aal.nii.gz --origin 0,0,90 --direction 0,0,-1 --image seen.exr --format json\n",
    .groups = groups,
    .settings_size = sizeof(struct query_settings),
    .more_help = help_scores,
    .run = run,
};
