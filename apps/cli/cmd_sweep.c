/* SPDX-License-Identifier: BSD-3-Clause */
/* conus sweep: the angles that admit areas, shares at several angles, probabilities under errors of the pose. */
#include "cli/commands.h"
#include "cli/request.h"
#include "options/messages.h"
#include "options/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct sweep_settings {
    struct request_settings request; /* first */
    const char *angles;
    const char *jitter;
    uint32_t samples;
};

static const struct option sweep_options[] = {
    {OPTION_VALUED("angles", struct sweep_settings, angles, "A,B,...|LOW:HIGH:STEP"),
     .help = "report the shares at each of these full opening angles, degrees", .words = "widths", .common = true,
     .role = OPTION_ASKS, .excludes = "jitter,angle"},
    {OPTION_VALUED("jitter", struct sweep_settings, jitter, "DEGREES,MM|NAME"),
     .help = "or report the probabilities under normal errors of the pose: standard deviations of the axis's tilt "
             "about two axes, and of the position along three; or NAME, a published error, below; or --jitter columns: "
             "those of columns error_deg and error_mm of --pose FILE",
     .words = "uncertain, uncertainty, confidence", .common = true, .role = OPTION_ASKS},
    {OPTION_VALUED("samples", struct sweep_settings, samples, "N"),
     .help = "with --jitter: number of random poses, a power of two from 16 to 1048576",
     .standard = OPTION_DIGITS(JITTER_SAMPLES), OPTION_FROM_TO(16, 1048576), .needs = "jitter"},
    {0},
};

static const struct option_group groups[] = {
    {"What is asked (default: the angle from which on each area is in the cone)", sweep_options, 0},
    REQUEST_AIM_GROUPS,
    REQUEST_ENGINE_GROUPS,
    REQUEST_ATLAS_GROUPS,
    REQUEST_MORE_ATLASES,
    {"What is written", format_options, REQUEST_FIELD(answer)},
    {"", answer_output_options, REQUEST_FIELD(answer)},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/** A sweep under way. */
struct sweep {
    const struct sweep_settings *settings;
    struct request request;
    const char *rows;
    double *angles; /* of --angles, degrees */
    size_t angle_count;
    conus_jitter_options jitter;
    bool jitter_of_rows; /* the errors are those of the file's columns */
};

static bool refuse_angles(const struct sweep *sweep, const char *why)
{
    return refuse("--angles: \"%s\" %s", sweep->settings->angles, why);
}

static bool read_angles(struct sweep *sweep)
{
    double range[3];
    const char *text = sweep->settings->angles;
    sweep->angles = malloc(ANGLE_LIMIT * sizeof *sweep->angles);
    if (!sweep->angles) {
        return refuse("not enough memory");
    }
    if (strchr(text, ':')) {
        if (numbers_parse(range, 3, text, ':') != 3) {
            return refuse_angles(sweep, "is not three numbers LOW:HIGH:STEP");
        }
        /* LOW, LOW + STEP and so on up to HIGH, which is taken even if rounding puts it a little beyond. */
        size_t count = angles_count(range);
        if (!count) {
            return refuse_angles(sweep, "is not LOW:HIGH:STEP with HIGH from LOW on and STEP above 0");
        }
        if (count > ANGLE_LIMIT) {
            return refuse_angles(sweep, "has more than 1000 angles");
        }
        for (size_t i = 0; i < count; i++) {
            sweep->angles[sweep->angle_count++] = angles_at(range, i);
        }
    } else {
        sweep->angle_count = numbers_parse(sweep->angles, ANGLE_LIMIT, text, ',');
        if (!sweep->angle_count) {
            return refuse_angles(sweep, "is neither up to 1000 numbers A,B,... nor LOW:HIGH:STEP");
        }
    }
    for (size_t i = 0; i < sweep->angle_count; i++) {
        if (!(sweep->angles[i] > 0 && sweep->angles[i] < 180)) {
            return refuse("--angles: %.10g is out of range, allowed is more than 0 and less than 180",
                          sweep->angles[i]);
        }
    }
    return true;
}

static bool read_jitter(struct sweep *sweep)
{
    const struct sweep_settings *settings = sweep->settings;
    sweep->jitter_of_rows = strcmp(settings->jitter, "columns") == 0;
    if (sweep->jitter_of_rows && !settings->request.aim.pose) {
        return refuse("--jitter columns: without --pose FILE there are none");
    }
    return settings_jitter(&sweep->jitter, sweep->jitter_of_rows ? "0,0" : settings->jitter, settings->samples, false);
}

/* Options that would have no effect, or no meaning. */
static bool check_kind(const struct sweep *sweep, const struct arguments *arguments)
{
    const struct sweep_settings *settings = sweep->settings;
    if (strcmp(sweep->rows, "chances") != 0 && settings->request.engine.radius > 0) {
        return refuse("--radius makes a cylinder, which has no angle to sweep; it goes with --jitter");
    }
    /* No ray decides which angle admits an object: a round cone holds what lies in it, hidden or not. */
    const struct option *of_rays = option_with(arguments, OPTION_OF_RAYS);
    if (strcmp(sweep->rows, "admissions") == 0 && of_rays) {
        return refuse("--%s has no effect without --angles or --jitter", of_rays->name);
    }
    return true;
}

static conus_status add_shares(struct sweep *sweep, const struct answerer *answerer, const conus_pose_row *row)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sweep->angle_count; i++) {
        conus_selection *selection = NULL;
        status = conus_select(&selection, answerer->selector, &row->pose, sweep->angles[i]);
        status = status ? status : conus_report_add(answerer->report, row->id, selection);
        conus_selection_destroy(selection);
    }
    return status;
}

static conus_status add_admissions(const struct answerer *answerer, const conus_pose_row *row, double angle)
{
    conus_table *table = NULL;
    conus_status status = conus_sweep(&table, answerer->selector, &row->pose, angle);
    status = status ? status : conus_report_add_table(answerer->report, row->id, table);
    conus_table_destroy(table);
    return status;
}

static bool has_errors(const conus_pose_row *row)
{
    return isfinite(row->error_deg) || isfinite(row->error_mm);
}

static bool show_sample(void *user, size_t done, size_t total)
{
    (void)total;
    request_show_step(user, done);
    return true;
}

/* The errors on the command line win; a row's own error that is missing is 0. */
static conus_status add_chances(struct sweep *sweep, const struct answerer *answerer, const conus_pose_row *row,
                                double angle)
{
    conus_table *table = NULL;
    conus_jitter_options options = sweep->jitter;
    options.progress = show_sample;
    options.progress_user = &sweep->request;
    if (sweep->jitter_of_rows) {
        options.tilt = isfinite(row->error_deg) ? row->error_deg : 0;
        options.shift = isfinite(row->error_mm) ? row->error_mm : 0;
    }
    conus_status status = conus_jitter(&table, answerer->selector, &row->pose, angle, &options);
    status = status ? status : conus_report_add_table(answerer->report, row->id, table);
    conus_table_destroy(table);
    return status;
}

static conus_status add_answers(struct sweep *sweep, const conus_pose_row *row)
{
    struct request *request = &sweep->request;
    double angle = request_angle(request, row);
    conus_status status = CONUS_OK;
    double widest = strcmp(sweep->rows, "shares") == 0 ? 0 : angle;
    for (size_t i = 0; i < sweep->angle_count; i++) {
        widest = fmax(widest, sweep->angles[i]);
    }
    request_count_pose(request, row->line, &row->pose, widest);
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        const struct answerer *answerer = &request->answerers[i];
        status = conus_selector_set_range(answerer->selector, row->range);
        status = status                                ? status
                 : strcmp(sweep->rows, "shares") == 0  ? add_shares(sweep, answerer, row)
                 : strcmp(sweep->rows, "chances") == 0 ? add_chances(sweep, answerer, row, angle)
                                                       : add_admissions(answerer, row, angle);
    }
    return status;
}

static int answer_row(void *user, const conus_pose_row *row)
{
    struct sweep *sweep = user;
    const char *why = row->error                                  ? row->error
                      : row->is_point                             ? POINT_HAS_NO_DIRECTION
                      : sweep->jitter_of_rows && !has_errors(row) ? "no error_deg or error_mm for --jitter columns"
                                                                  : NULL;
    conus_status status = why ? CONUS_OK : add_answers(sweep, row);
    if (status == CONUS_ERROR_ARGUMENT) {
        why = conus_message();
    }
    return why ? request_refuse_row(&sweep->request, row, why) : print_status(status);
}

/* Errors in the file that --jitter on the command line overrides. */
static void say_unused_errors(const struct sweep *sweep)
{
    bool said = sweep->settings->request.common.quiet || strcmp(sweep->rows, "chances") != 0 || sweep->jitter_of_rows;
    for (size_t i = 0; !said && i < conus_pose_list_count(sweep->request.poses); i++) {
        said = has_errors(conus_pose_list_row(sweep->request.poses, i));
        if (said) {
            print_error_line(
                "note: %s: error_deg and error_mm are not used, --jitter %s is; --jitter columns takes them",
                pose_settings_file_name(sweep->settings->request.aim.pose), sweep->settings->jitter);
        }
    }
}

/* A place that a cap found, with the error of a navigated coil. */
static void say_cap(const struct sweep *sweep, const conus_pose_error *error)
{
    const struct named_places *places = &sweep->request.places;
    for (size_t i = 0; i < places->count && strcmp(error->name, "tms-navigated") == 0; i++) {
        const conus_named_place *item = &places->items[i];
        const bool is_cap = strcmp(item->option, "origin") == 0 && item->place.kind == CONUS_PLACE_POSITION;
        say_note(
            CONUS_SEVERITY_NOTE, !is_cap || sweep->settings->request.common.quiet,
            "--jitter tms-navigated is how far a navigated coil repeats a saved pose; a place that a cap finds, as "
            "%s, is off by tms-cap",
            item->place.name);
    }
}

static int answer_all(struct sweep *sweep)
{
    struct request *request = &sweep->request;
    request->steps =
        strcmp(sweep->rows, "chances") == 0 ? (sweep->jitter.samples ? sweep->jitter.samples : JITTER_SAMPLES) : 0;
    if (request->poses) {
        say_unused_errors(sweep);
        return request_each_row(request, answer_row, sweep);
    }
    conus_pose_row row = {.id = "1", .pose = request->aim, .error_deg = NAN, .error_mm = NAN};
    double angle;
    int code =
        settings_pose_cone(&angle, row.range, request->aim_target, &request->settings->aim, &request->settings->engine);
    if (code) {
        return code;
    }
    request_start_progress(request, 1);
    conus_status status = add_answers(sweep, &row);
    progress_finish(&request->progress, 0, 0);
    return print_status(status);
}

static void help_of_sweep(FILE *out)
{
    help_scores(out);
    fputs("\n", out);
    help_errors(out);
}

static int answer_sweep(struct sweep *sweep)
{
    struct request *request = &sweep->request;
    int code = request_load(request, NULL, NULL);
    code = code ? code : request_match(request);
    code = code ? code : request_find_aim(request);
    code = code ? code : request_check_outputs(request);
    if (code) {
        return code;
    }
    const conus_selector_options engine = settings_engine(&request->settings->engine, NULL, &request->settings->common);
    conus_report_options report = request_report_options(request);
    report.rows = sweep->rows;
    conus_status status = request_start(request, &engine);
    status = status ? status : request_reports(request, &report);
    code = status ? print_status(status) : answer_all(sweep);
    if (code) {
        return code;
    }
    request_say_notes(request);
    request_say_aims(request);
    struct provenance provenance = {0};
    conus_pose_error error;
    provenance.error = !sweep->jitter_of_rows && settings_error(&error, sweep->settings->jitter, false) ? &error : NULL;
    if (provenance.error) {
        say_cap(sweep, &error);
    }
    request_list_inputs(&provenance, request);
    provenance.question.rows = sweep->rows;
    return request_code(request, request_write_answer(request, &provenance));
}

static int run_sweep(const void *given, const struct arguments *arguments)
{
    const struct sweep_settings *settings = given;
    struct sweep sweep = {.settings = settings,
                          .rows = settings->angles   ? "shares"
                                  : settings->jitter ? "chances"
                                                     : "admissions"};
    int code = EXIT_USAGE;
    if (request_check(&settings->request, arguments, false) && settings_check_aim(arguments, true) &&
        check_kind(&sweep, arguments) && (!settings->angles || read_angles(&sweep)) &&
        (!settings->jitter || read_jitter(&sweep))) {
        code = request_init(&sweep.request, &settings->request, arguments);
        code = code ? code : answer_sweep(&sweep);
    }
    request_finish(&sweep.request);
    free(sweep.angles);
    return code;
}

const struct command cmd_sweep = {
    .name = "sweep",
    .summary = "give answers over many angles, or under errors of the pose",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "(--origin X,Y,Z (--toward X,Y,Z | --direction X,Y,Z) | --pose FILE)",
    .description =
        "Opens a cone from 0 to --angle and says at which angle it admits each area, occluded ones, too, and how\n"
        "much further it must open for the next. Or, with --angles, gives the shares at each angle; or, with\n"
        "--jitter, the probability of each area to be the one hit when the pose is not exactly known.",
    .examples = "  conus sweep aal.nii.gz --origin -90,20,20 --toward 0,-10,10 --angle 40\n"
                "  conus sweep aal.nii.gz --origin -90,20,20 --toward 0,-10,10 --angles 2:20:2\n"
                "  conus sweep aal.nii.gz --origin -90,20,20 --toward 0,-10,10 --angle 5 --jitter 2,1.5\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct sweep_settings),
    .more_help = help_of_sweep,
    .run = run_sweep,
};
