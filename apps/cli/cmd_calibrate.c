/* SPDX-License-Identifier: BSD-3-Clause */
/* conus calibrate: how far off a device points, by trials with known aims; or how often posteriors are right. */
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "options/messages.h"

#include <stdlib.h>
#include <string.h>

enum { FEW_TRIALS = 20 };

static const struct option trial_options[] = {
    {OPTION_VALUED("poses", struct request_settings, aim.pose, "FILE"),
     .help = "the trials, poses as for conus query --pose, with columns aim_x, aim_y and aim_z (the point that was "
             "aimed at, in the space of the poses) or, with ATLAS, meant (the area that was meant: a name, an "
             "abbreviation or a label); - for standard input",
     .words = "trials, pointing", .common = true, .required = true, .role = OPTION_READS_POSES, .flags = OPTION_OF_CONE,
     .holds = HOLDS_POSES},
    {0},
};

static const struct option_group groups[] = {
    {"Which trials", trial_options, 0},
    {"", pose_file_options, REQUEST_FIELD(file)},
    {"", space_options, REQUEST_FIELD(aim.space)},
    {"With ATLAS: what the posteriors are", weight_options, REQUEST_FIELD(engine)},
    {"", angle_options, REQUEST_FIELD(aim)},
    {"", ray_options, REQUEST_FIELD(engine.numbers)},
    {"", pixel_options, REQUEST_FIELD(engine)},
    {"", request_level_options, 0},
    {"With ATLAS: what can be hit", atlas_options, REQUEST_FIELD(atlas)},
    {"", side_options, REQUEST_FIELD(atlas)},
    {"", shown_options, REQUEST_FIELD(atlas)},
    REQUEST_OUTPUT_GROUPS,
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/** A calibration under way. */
struct calibration {
    const struct request_settings *settings;
    struct request request;
    conus_trial *trials;
    size_t count;
    conus_table *found;
    conus_report *report; /* of trials without an atlas */
};

/* The first option that was given and says something of an atlas; NULL: none does. */
static const struct option *option_of_atlas(const struct arguments *arguments)
{
    static const struct option *const others[] = {
        trial_options, pose_file_options, space_options, format_options, answer_output_options, quiet_options, NULL};
    const struct option *found = NULL;
    for (size_t i = 0; i < arguments->use_count && !found; i++) {
        found = arguments->uses[i].option;
        found = found->role == OPTION_KEPT ? NULL : found; /* --max-memory, of the poses, too */
        for (size_t t = 0; others[t] && found; t++) {
            for (const struct option *option = others[t]; option->name && found; option++) {
                found = option == found ? NULL : found;
            }
        }
    }
    return found;
}

static const char *file_of(const struct calibration *calibration)
{
    return pose_settings_file_name(calibration->settings->aim.pose);
}

static int load_trials(void *user)
{
    static const char *const columns[] = {"meant"};
    struct calibration *calibration = user;
    struct request *request = &calibration->request;
    const char *path = request->settings->aim.pose;
    conus_pose_options options = request_pose_options(request);
    options.keep = request->atlases.count ? columns : NULL;
    options.keep_count = request->atlases.count ? 1 : 0;
    conus_status status = conus_pose_list_load(&request->poses, path, &options);
    if (status) {
        return pose_settings_print_error(status, path, "pose", request->arguments);
    }
    calibration->count = conus_pose_list_count(request->poses);
    calibration->trials = calloc(calibration->count + 1, sizeof *calibration->trials);
    return calibration->trials ? EXIT_DONE : print_no_memory();
}

/* The trial that a row is; CONUS_ERROR_ARGUMENT where it is none. */
static conus_status take_row(conus_trial *out, const struct request *request, const conus_pose_row *row)
{
    *out = (conus_trial){.pose = row->pose, .angle = request_angle(request, row)};
    memcpy(out->aim, row->aim, sizeof out->aim);
    memcpy(out->range, row->range, sizeof out->range);
    return request->atlases.count ? conus_atlas_find(&out->meant, request->atlases.items[0].atlas, row->kept[0])
                                  : CONUS_OK;
}

static int take_trials(struct calibration *calibration)
{
    const struct request *request = &calibration->request;
    int code = EXIT_DONE;
    for (size_t i = 0; i < calibration->count && !code; i++) {
        const conus_pose_row *row = conus_pose_list_row(request->poses, i);
        const char *why = pose_settings_row_error(row);
        why = !why && take_row(&calibration->trials[i], request, row) ? conus_message() : why;
        code = why ? print_data_error("%s:%zu: %s", file_of(calibration), row->line, why) : EXIT_DONE;
    }
    return code;
}

static bool show_trial(void *user, size_t done, size_t total)
{
    struct request *request = user;
    (void)total;
    request->row = done;
    request_show_step(request, 0);
    return true;
}

/* What trials of an atlas say. */
static int find_reliability(struct calibration *calibration, const conus_report_options *report)
{
    struct request *request = &calibration->request;
    struct engine_settings settings = request->settings->engine;
    settings.prior = settings.prior ? settings.prior : "equal";
    const conus_selector_options engine =
        settings_engine(&settings, &request->settings->aim, &request->settings->common);
    conus_status status = request_start(request, &engine);
    status = status ? status : request_reports(request, report);
    if (status) {
        return print_status(status);
    }
    request_start_progress(request, calibration->count);
    status = conus_reliability(&calibration->found, request->answerers[0].selector, calibration->trials,
                               calibration->count, show_trial, request);
    progress_finish(&request->progress, 0, 0);
    return status ? print_data_error("%s: %s", file_of(calibration), conus_message()) : EXIT_DONE;
}

static int find_errors(struct calibration *calibration, const conus_report_options *report)
{
    conus_status status = conus_report_create(&calibration->report, NULL, report);
    if (status) {
        return print_status(status);
    }
    status = conus_calibrate(&calibration->found, calibration->trials, calibration->count);
    return status ? print_data_error("%s: %s", file_of(calibration), conus_message()) : EXIT_DONE;
}

static int write_found(struct calibration *calibration)
{
    struct request *request = &calibration->request;
    const bool has_atlas = request->atlases.count;
    conus_report *report = has_atlas ? request->answerers[0].report : calibration->report;
    struct provenance provenance = {0};
    conus_status status = conus_report_add_table(report, "1", calibration->found);
    if (status) {
        return print_status(status);
    }
    say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet || calibration->count >= FEW_TRIALS,
             "%zu trials are few: the intervals are wide, and nothing is known of rare errors; %d and more are better",
             calibration->count, FEW_TRIALS);
    request_list_inputs(&provenance, request);
    provenance.question.rows = has_atlas ? "reliability" : "calibration";
    provenance.question.region = has_atlas ? "cone" : "all";
    return answer_write(report, request->settings->answer.output, request->sidecar, &provenance);
}

static int answer_calibrate(struct calibration *calibration)
{
    struct request *request = &calibration->request;
    const struct request_settings *settings = request->settings;
    const bool has_atlas = request->arguments->operand_count;
    int code;
    if (has_atlas) {
        code = request_load(request, load_trials, calibration);
        code = code ? code : request_match(request);
    } else {
        const struct space_settings *space = &settings->aim.space;
        code = print_status(conus_frame_find(&request->frame, NULL, (conus_space)space->name, NULL));
        code = code ? code : load_trials(calibration);
    }
    code = code ? code : request_check_outputs(request);
    code = code ? code : take_trials(calibration);
    conus_report_options report = request_report_options(request);
    report.marks = NULL;
    report.rows = has_atlas ? "reliability" : "calibration";
    code = code ? code : (has_atlas ? find_reliability : find_errors)(calibration, &report);
    if (code) {
        return code;
    }
    if (has_atlas) {
        request_say_notes(request);
        settings_say_weight(&settings->aim, &settings->engine, &settings->common, request->atlases.items[0].atlas);
    }
    return write_found(calibration);
}

static int ask(const struct request_settings *settings, const struct arguments *arguments)
{
    struct calibration calibration = {.settings = settings};
    const struct option *of_atlas = arguments->operand_count ? NULL : option_of_atlas(arguments);
    if (of_atlas) {
        return print_usage_error("--%s has no effect without ATLAS", of_atlas->name);
    }
    if (!arguments->operand_count && settings->aim.space.name >= CONUS_SPACE_CCF) {
        return print_usage_error("--space: trials without ATLAS are read in ras or lps");
    }
    if (arguments->operand_count && !settings->engine.weight) {
        return print_usage_error("ATLAS needs --weight with it, of which posteriors are");
    }
    if (!request_check(settings, arguments, false)) {
        return EXIT_USAGE;
    }
    int code = request_init(&calibration.request, settings, arguments);
    code = code ? code : answer_calibrate(&calibration);
    conus_table_destroy(calibration.found);
    conus_report_destroy(calibration.report);
    free(calibration.trials);
    request_finish(&calibration.request);
    return code;
}

static int run_calibrate(const void *given, const struct arguments *arguments)
{
    struct request_settings settings = *(const struct request_settings *)given;
    int code = settings_weight(&settings.aim, &settings.engine, arguments);
    code = code ? code : ask(&settings, arguments);
    settings_weight_finish(&settings.engine);
    return code;
}

const struct command cmd_calibrate = {
    .name = "calibrate",
    .summary = "find from trials how far off a hand or tracker points, and how often posteriors are right",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .optional_last = true,
    .form = "--poses FILE",
    .description =
        "Without ATLAS, of trials that aim at known points: how far the device points to the right and up of them in\n"
        "the mean (bias), how widely (sigma), whether such errors are normal and alike in all directions, and the\n"
        "--weight of conus query that says so. With ATLAS and --weight, of trials that mean a known area: how often\n"
        "the area with the largest posterior is that one, beside how large that posterior is; and which power of\n"
        "--prior makes posteriors the most honest.",
    .examples = "  conus calibrate --poses trials.tsv\n"
                "  conus calibrate aal --poses meant.tsv --weight gauss=1.7\n"
                "  conus calibrate aal --poses meant.tsv --weight gauss=1.7,bias=0.6:-0.5 --prior equal,power=2\n",
    .see_also = "  conus query     what a pose points at: --weight, --score posterior\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct request_settings),
    .run = run_calibrate,
};
