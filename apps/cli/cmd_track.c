/* SPDX-License-Identifier: BSD-3-Clause */
/* conus track: the poses of a moving device, from a file, a pipe or a tracker, each ranked with those before it. */
#include "base/system/system.h"
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "link/station.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"
#include "settings/settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct track_settings {
    struct request_settings request; /* first */
    struct station_settings station;
    double seconds;
    conus_tracker_options constants;
    bool selected;
};

static const struct option pose_options[] = {
    {OPTION_VALUED("poses", struct request_settings, aim.pose, "FILE"),
     .help = "poses of the device over time, for instance a table with columns time_s and, if wanted, trigger "
             "(docs/formats.md); - is standard input",
     .words = "input", .common = true, .role = OPTION_READS_POSES, .holds = HOLDS_POSES},
    {0},
};

static const struct option live_options[] = {
    {OPTION_VALUED("seconds", struct track_settings, seconds, "S"), .help = "listen for this many seconds",
     .otherwise = "until interrupted by Ctrl-C", OPTION_BETWEEN(0, 1e9), .role = OPTION_LIVE, .needs = "listen|connect",
     .unit = "s"},
    {0},
};

static const struct option history_options[] = {
    {OPTION_VALUED("delay", struct track_settings, constants.delay, "SECONDS"),
     .help = "a press confirms what was selected this long before it, 0 to 10 s, at most the window",
     .standard = "0.15", OPTION_FROM_TO(0, 10), .unit = "s"},
    {OPTION_VALUED("window", struct track_settings, constants.window, "SECONDS"),
     .help = "time over which the scores time and stability are measured; after a longer gap between poses the history "
             "starts afresh",
     .standard = "2", OPTION_BETWEEN(0, 1e6), .unit = "s"},
    {OPTION_VALUED("stickiness", struct track_settings, constants.stickiness, "C"),
     .help = "IntenSelect's c_s: part of the score that a frame keeps, between 0 and 1", .standard = "0.5",
     OPTION_BETWEEN(0, 1)},
    {OPTION_VALUED("snappiness", struct track_settings, constants.snappiness, "C"),
     .help = "IntenSelect's c_g: part of the new score that a frame adds, 0.001 to 1", .standard = "0.5",
     OPTION_FROM_TO(0.001, 1)},
    {OPTION_VALUED("rate", struct track_settings, constants.rate, "HZ"),
     .help = "frames per second for c_s and c_g, independent of the poses' rate", .standard = "60",
     OPTION_BETWEEN(0, 1e6), .unit = "Hz"},
    {OPTION_VALUED("growth", struct track_settings, constants.growth, "RATE"),
     .help = "rate at which a score of IntenSelect+ grows, per second", .standard = "7.5", OPTION_BETWEEN(0, 1e6),
     .unit = "1/s"},
    {OPTION_VALUED("decay", struct track_settings, constants.decay, "RATE"),
     .help = "rate at which a score of IntenSelect+ decays, per second", .standard = "5", OPTION_BETWEEN(0, 1e6),
     .unit = "1/s"},
    {OPTION_VALUED("exponent", struct track_settings, constants.exponent, "K"),
     .help = "exponent k of IntenSelect and IntenSelect+, 0.01 to 1; with 1 the distance does not matter",
     .standard = "0.8", OPTION_FROM_TO(0.01, 1)},
    {0},
};

static const struct option output_options[] = {
    {OPTION_NAMED("selected", struct track_settings, selected),
     .help = "write only the selected and the confirmed object of each step"},
    {0},
};

static const struct option_group groups[] = {
    {"Where the device is", pose_options, 0},
    {"", pose_file_options, REQUEST_FIELD(file)},
    {"Poses from a tracker", station_options_table, offsetof(struct track_settings, station)},
    {"", live_options, 0},
    {"", angle_options, REQUEST_FIELD(aim)},
    {"", space_options, REQUEST_FIELD(aim.space)},
    {"", shape_options, REQUEST_FIELD(engine)},
    REQUEST_ENGINE_GROUPS,
    {"History", history_options, 0},
    REQUEST_ATLAS_GROUPS,
    REQUEST_MORE_ATLASES,
    {"What is written", format_options, REQUEST_FIELD(answer)},
    {"", answer_output_options, REQUEST_FIELD(answer)},
    {"", output_options, 0},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/** A track under way. */
struct track {
    const struct track_settings *settings;
    struct request request;
    struct station *station;  /* NULL where the poses come from a file */
    conus_tracker **trackers; /* [request.atlases.count] */
    struct system_text held;  /* what goes to a file, which appears whole or not at all; none for stdout */
};

/* Writes what was answered since the last time. A whole JSON text waits for the end. */
static int write_steps(struct track *track)
{
    const char *text = NULL;
    size_t size = 0;
    if (format_is(track->request.format, "json")) {
        return EXIT_DONE;
    }
    conus_status status = conus_report_take(&text, &size, track->request.answerers[0].report);
    if (status) {
        return print_status(status);
    }
    if (!track->held.stream) {
        return output_write(NULL, text, size);
    }
    if (fwrite(text, 1, size, track->held.stream) != size) {
        return print_no_memory();
    }
    return EXIT_DONE;
}

/* A step of all atlases. A station gets the answer of the first. Where the step itself is at fault, nothing is printed
 * or reported, and *fault is set. */
static int answer_step(struct track *track, const conus_pose_row *row, bool *fault)
{
    struct request *request = &track->request;
    double angle = request_angle(request, row);
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        const struct answerer *answerer = &request->answerers[i];
        conus_selection *selection = NULL;
        status = conus_selector_set_range(answerer->selector, row->range);
        status = status
                     ? status
                     : conus_tracker_step(&selection, track->trackers[i], row->time_s, &row->pose, angle, row->trigger);
        *fault = status == CONUS_ERROR_ARGUMENT && i == 0;
        if (*fault) {
            return EXIT_DONE;
        }
        status = status ? status : conus_report_add(answerer->report, row->id, selection);
        if (!status && track->station && i == 0) {
            station_send_selection(track->station, answerer->selector, request->atlases.items[0].atlas, selection);
        }
        conus_selection_destroy(selection);
    }
    return status ? print_status(status) : write_steps(track);
}

static int answer_row(struct track *track, const conus_pose_row *row)
{
    struct request *request = &track->request;
    bool fault = false;
    if (row->error || row->is_point) {
        return request_skip_row(request, row, row->error ? row->error : POINT_HAS_NO_DIRECTION);
    }
    if (isnan(row->time_s)) {
        return request_skip_row(request, row, "no time_s, which a step needs");
    }
    request_count_pose(request, row->line, &row->pose, request_angle(request, row));
    int code = answer_step(track, row, &fault);
    return fault ? request_skip_row(request, row, conus_message()) : code;
}

static int answer_update(struct track *track, const struct station_update *update, double time_s)
{
    char id[24];
    bool fault = false;
    const conus_pose_row row = {.id = id, .pose = update->pose, .time_s = time_s, .range = {NAN, NAN}};
    snprintf(id, sizeof id, "%llu", (unsigned long long)update->number);
    int code = answer_step(track, &row, &fault);
    code = fault ? print_status(CONUS_ERROR_ARGUMENT) : code;
    return code || track->held.stream || !fflush(stdout) ? code : EXIT_DATA;
}

/* Answers poses as they arrive, with times by this machine's clock from the first pose on. Poses that come faster than
 * they are answered are passed over. */
static int answer_station(struct track *track)
{
    const double seconds = track->settings->seconds;
    struct station_update update = {0};
    double first = NAN;
    int code = EXIT_DONE;
    double begun = clock_ms();
    interrupt_catch(NULL);
    if (!track->request.settings->common.quiet) {
        char text[160];
        station_settings_text(text, sizeof text, track->station, &update);
        print_error_line("%s", text);
    }
    while (!code && !interrupt_signal() && !(seconds > 0 && clock_ms() - begun >= 1e3 * seconds)) {
        if (station_wait(track->station, update.number, 0.05, &update) && update.state == STATION_SEEN) {
            first = isnan(first) ? clock_ms() : first;
            code = answer_update(track, &update, 1e-3 * (clock_ms() - first));
        }
    }
    return code ? code : write_steps(track);
}

/* Answers one row at a time, so that what comes through a pipe is answered as it comes. A signal ends a pipe, and what
 * it brought is kept; a file is another matter: half of its steps are no answer. */
static int answer_all(struct track *track)
{
    if (conus_pose_stream_facts(track->request.stream).is_live) {
        interrupt_catch(track->request.stream);
    }
    size_t count = 0;
    uint64_t rows = 0;
    int code = EXIT_DONE;
    do {
        conus_pose_row row;
        conus_status status = conus_pose_stream_read(&row, &count, track->request.stream, 1);
        code = status ? print_status(status) : count ? answer_row(track, &row) : EXIT_DONE;
        rows += count;
    } while (!code && count);
    interrupt_release();
    if (!code && !rows) {
        pose_settings_say_none(track->request.settings->aim.pose, &track->request.settings->common);
    }
    return code ? code : write_steps(track); /* without a step there is still a header row */
}

static conus_status start_track(struct track *track)
{
    struct request *request = &track->request;
    const conus_selector_options engine = settings_engine(&request->settings->engine, NULL, &request->settings->common);
    conus_tracker_options constants = track->settings->constants;
    conus_report_options report = request_report_options(request);
    report.selected_only = track->settings->selected;
    if (option_given(request->arguments, "delay") && constants.delay == 0) {
        constants.delay = -1; /* none; 0 is the default */
    }
    if (option_restated(request->arguments, "delay")) { /* at most the window, as any other */
        number_parse(option_standard(option_find(request->arguments->command, "delay")), &constants.delay);
    }
    conus_status status = request_start(request, &engine);
    for (size_t i = 0; i < request->atlases.count && !status; i++) {
        status = conus_tracker_create(&track->trackers[i], request->answerers[i].selector, &constants);
        report.tracker = track->trackers[i];
        status = status ? status : request_report(request, i, &report);
    }
    return status;
}

/* Writes the rest when the last row is answered; the answer's own file last. */
static int write_rest(struct track *track)
{
    const struct request *request = &track->request;
    const char *output = request->settings->answer.output;
    conus_report *report = request->answerers[0].report;
    struct provenance provenance = {.poses = request->stream};
    request_list_inputs(&provenance, request);
    provenance.question.rows = "steps";
    if (format_is(request->format, "json")) {
        return answer_write(report, output, NULL, &provenance);
    }
    if (track->held.stream && !system_text_close(&track->held)) {
        return print_no_memory();
    }
    int code = answer_write_sidecar(report, output, request->sidecar, &provenance, track->held.data, track->held.size);
    return code || !track->held.data ? code : output_write(output, track->held.data, track->held.size);
}

static int open_poses(void *user)
{
    struct track *track = user;
    struct request *request = &track->request;
    const char *path = request->settings->aim.pose;
    if (!path) {
        return station_settings_start(&track->station, &track->settings->station);
    }
    const conus_pose_options options = request_pose_options(request);
    conus_status status = conus_pose_stream_open(&request->stream, path, &options);
    if (!status && !conus_pose_stream_facts(request->stream).has_times) {
        return print_data_error("%s: no time_s in it, which every step needs", pose_settings_file_name(path));
    }
    return status ? pose_settings_print_error(status, path, "poses", request->arguments) : EXIT_DONE;
}

static int answer_track(struct track *track)
{
    struct request *request = &track->request;
    int code = request_load(request, open_poses, track);
    code = code ? code : request_check_outputs(request);
    code = code ? code : request_match(request);
    if (code) {
        return code;
    }
    request_say_notes(request);
    track->trackers = calloc(request->atlases.count, sizeof(conus_tracker *));
    if (!track->trackers) {
        return print_no_memory();
    }
    conus_status status = start_track(track);
    code = status ? print_status(status) : track->station ? answer_station(track) : answer_all(track);
    /* A hand points here and there: only where the whole track lies or points astray may it be in another space. */
    bool is_off = false;
    for (size_t i = 0; i < request->atlases.count && !code && !is_off; i++) {
        const conus_pose_findings *found = conus_pose_check_found(request->answerers[i].aims);
        uint64_t poses = found->poses;
        is_off = poses && (found->away.count == poses || found->inside.count == poses || found->tiny.count == poses);
    }
    if (!code && is_off) {
        request_say_aims(request);
    }
    return request_code(request, code ? code : write_rest(track));
}

static int run_track(const void *given, const struct arguments *arguments)
{
    const struct track_settings *settings = given;
    bool live = option_given(arguments, "listen") || option_given(arguments, "connect");
    if (live == option_given(arguments, "poses")) {
        return print_usage_error(live ? "poses come from a file or from a tracker, not from both"
                                      : "no poses: --poses FILE, or a tracker by --listen or --connect");
    }
    if (live && settings->request.engine.range.to_target) {
        return print_usage_error("--range NEAR,target needs a file of poses: a tracker sends no targets");
    }
    if (!station_settings_check(&settings->station, arguments) || !request_check(&settings->request, arguments, true)) {
        return EXIT_USAGE;
    }
    struct track track = {.settings = settings};
    int code = request_init(&track.request, &settings->request, arguments);
    /* A file appears whole or not at all: what goes to one is held. */
    if (!code && !output_is_stdout(settings->request.answer.output) && !format_is(track.request.format, "json")) {
        code = system_text_open(&track.held) ? EXIT_DONE : print_no_memory();
    }
    code = code ? code : answer_track(&track);
    if (track.held.stream) {
        system_text_close(&track.held);
    }
    free(track.held.data);
    for (size_t i = 0; track.trackers && i < track.request.atlases.count; i++) {
        conus_tracker_destroy(track.trackers[i]);
    }
    free((void *)track.trackers);
    station_stop(track.station);
    request_finish(&track.request);
    return code;
}

const struct command cmd_track = {
    .name = "track",
    .summary = "answer a moving device's poses with a history",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "(--poses FILE | --listen PORT | --connect HOST)",
    .description =
        "Answers one pose after the other, as conus query does, and ranks what it hits together with\n"
        "earlier hits, so that a trembling hand selects one area and not several. Rows are in order of\n"
        "time_s, at any rate; a row before its predecessor is left out with a message. Where a column trigger\n"
        "goes from 0 to 1, the area that was selected a moment before, when the press had not yet moved the\n"
        "hand, is confirmed. Steps are written as they come.",
    .examples = "  conus track aal.nii.gz --poses hand.tsv --score intenselect --selected\n"
                "  tracker | conus track aal.nii.gz --poses - --score 0.7*intenselect_plus+0.3*time --format ndjson\n"
                "  conus track aal.nii.gz --poses hand.tsv --angle 5 -o steps.tsv\n"
                "  conus track aal.nii.gz --listen 18944 --tool Pointer --reference Head --format ndjson\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct track_settings),
    .more_help = help_scores,
    .run = run_track,
};
