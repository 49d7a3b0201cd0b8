/* SPDX-License-Identifier: BSD-3-Clause */
/* conus query: what is in a cone or ball, with the tables, pictures and masks that belong to it. */
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/settings.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct query_settings {
    struct request_settings request; /* first */
    const char *voxels;
    size_t voxels_of;
    struct selection_file_settings files;
    struct axis_settings axis;
    struct ends_settings ends;
    struct option_list points; /* places */
    struct probe_settings probe;
    struct keep_settings keep;
    const char *probes;
    const char *coordsystem;
};

static const char *const voxel_kinds[] = {"pathways", "all", NULL};

static const struct option point_options[] = {
    {OPTION_VALUED("point", struct query_settings, points, PLACE_VALUE),
     .help = "instead of a cone, what is at this point, or else nearest to it; with --radius MM what is within MM of "
             "it; may be repeated",
     .words = "coordinate, whereami", .common = true, .role = OPTION_ASKS, .flags = OPTION_IS_PLACE},
    {0},
};

static const struct option probe_options[] = {
    {OPTION_VALUED("probes", struct query_settings, probes, "FILE.tsv"),
     .help = "with --format bep032: write the table of the probes, with the smallest area that contains all contacts",
     .needs = "probe", .endings = ".tsv", OPTION_WRITING(ROWS)},
    {OPTION_VALUED("coordsystem", struct query_settings, coordsystem, "FILE.json"),
     .help = "with --format bep032: positions are those in --space, in place of those on the probe, and FILE.json "
             "describes the space",
     .needs = "probe", .endings = ".json", OPTION_WRITING(SIDECAR)},
    {0},
};

static const struct option voxels_options[] = {
    {OPTION_VALUED("voxels", struct query_settings, voxels, "FILE.tsv"),
     .help = "write the voxels hit first, or with --layers all or --point those in the cone or ball and the points of "
             "streamlines there, with indices, positions and values",
     .flags = OPTION_OF_REGION, OPTION_WRITING(ROWS)},
    {OPTION_VALUED("voxels-of", struct query_settings, voxels_of, "KIND"),
     .help = "whose voxels:", .choices = voxel_kinds, .needs = "voxels"},
    {0},
};

static const struct option_group groups[] = {
    REQUEST_AIM_GROUPS,
    {"", point_options, 0},
    {"", beam_options, REQUEST_FIELD(aim)},
    {"", aperture_options, REQUEST_FIELD(aim)},
    {"", probe_settings_options, offsetof(struct query_settings, probe)},
    {"", probe_options, 0},
    REQUEST_ENGINE_GROUPS,
    {"", weight_options, REQUEST_FIELD(engine)},
    REQUEST_ATLAS_GROUPS,
    REQUEST_MORE_ATLASES,
    {"What is written", query_format_options, REQUEST_FIELD(answer)},
    {"", answer_output_options, REQUEST_FIELD(answer)},
    {"", keep_options, offsetof(struct query_settings, keep)},
    {"", axis_options, offsetof(struct query_settings, axis)},
    {"", endpoints_options, offsetof(struct query_settings, ends)},
    {"", connectivity_options, offsetof(struct query_settings, ends)},
    {"", voxels_options, 0},
    {"", selection_file_options, offsetof(struct query_settings, files)},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

static bool check_outputs(const struct query_settings *settings, const struct arguments *arguments)
{
    const char *format;
    if (settings->voxels && output_format(&format, settings->voxels) && !format_is(format, "tsv") &&
        !format_is(format, "table")) {
        return refuse("%s: --voxels writes TSV; end the name in .tsv", settings->voxels);
    }
    if (option_given(arguments, "endpoint-radius") && !settings->ends.endpoints && !settings->ends.connectivity) {
        return refuse("--endpoint-radius has no effect without --endpoints or --connectivity");
    }
    return ends_check(&settings->ends, arguments);
}

/** One run of the command. */
struct query_run {
    const struct query_settings *settings;
    struct request request;
    struct selection_files files;
    conus_contacts contacts;
    conus_probe *probe;
    bool is_of_points; /* poses of the file have no direction, and are asked all the same, */
    bool has_radii;    /* some of them within radii of their own */
    char understood[96];
    double (*points)[3]; /* of --point, world */
    struct kept_names kept;
    conus_pose_list *insertions; /* the poses of a file that say where the probes are; NULL = those of options */
    bool has_points, has_cones;  /* poses without a direction were asked, and with one */
    bool has_shanks;             /* answers along the axes of cones were asked */
    bool has_tracts;             /* pathways or bundles are in the answers */
    bool has_needles;            /* an axis ends at the target or at the depth that its file gives */
    size_t leads, first_lead;    /* of these begin outside of all objects; the line of the first, */
    double lead;                 /* and mm from there to an object */
};

/* Whether the format of another program has a place for this answer. */
static bool check_format(const struct request *request, const struct query_settings *settings)
{
    const char *format = request->format;
    if (format_of(format)->is_foreign && option_given(request->arguments, "atlas")) {
        return refuse("--format: formats of other programs have no column for the atlas; table, tsv, csv, json and "
                      "ndjson have one");
    }
    const char *why = format_is(format, "bep032") && !settings->probe.path
                          ? "--format: bep032 lists the contacts of probes; --probe FILE describes them"
                      : !format_is(format, "bep032") && settings->probes ? "--probes is written beside --format bep032"
                      : !format_is(format, "bep032") && settings->coordsystem
                          ? "--coordsystem is written beside --format bep032"
                      : format_is(format, "bids") && settings->probe.path
                          ? "--format: bids adds to a table of electrodes, --probe has none; bep032 writes one"
                          : NULL;
    if (why) {
        return refuse("%s", why);
    }
    if (format_of(format)->is_foreign && settings->keep.columns) {
        return refuse("--keep: formats of other programs have no place for it; table, tsv, csv, json and ndjson have");
    }
    bool of_contacts =
        format_is(format, "bids") || (format_of(format)->is_of_probe && option_given(request->arguments, "point"));
    if (of_contacts && !request->settings->aim.pose) {
        return refuse("--format: this format lists contacts; --pose FILE names them");
    }
    return true;
}

/* Some outputs need exactly one pose, and --angle needs a pose without an angle of its own. */
static int check_poses(struct query_run *run)
{
    const struct aim_settings *aim = &run->request.settings->aim;
    const conus_pose_list *poses = run->request.poses;
    size_t count = conus_pose_list_count(poses);
    char why[256];
    size_t points = 0;
    size_t radii = 0;
    for (size_t i = 0; i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        points += !row->error && row->is_point;
        radii += !row->error && row->is_point && !isnan(row->radius);
    }
    settings_point_error(why, &run->request.settings->engine, run->request.arguments);
    run->is_of_points = points && !why[0];
    run->has_radii = run->is_of_points && radii;
    if (points && points == count && why[0] && !run->settings->probe.path) {
        return print_data_error("%s: %s", pose_settings_file_name(aim->pose), why);
    }
    const struct option *of_one = option_with(run->request.arguments, OPTION_OF_ONE_POSE);
    if (of_one && count != 1) {
        return print_usage_error("--%s shows one pose, %s has %zu", of_one->name, pose_settings_file_name(aim->pose),
                                 count);
    }
    bool has_angle = option_given(run->request.arguments, "angle") || option_restated(run->request.arguments, "angle");
    for (size_t i = 0; i < count && has_angle; i++) {
        if (conus_pose_list_row(poses, i)->angle == 0) {
            return EXIT_DONE;
        }
    }
    return count && has_angle ? print_usage_error("--angle has no effect: every pose in %s has its own",
                                                  pose_settings_file_name(aim->pose))
                              : EXIT_DONE;
}

/* Asked of each atlas: a cone or cylinder, or a ball around a point. */
struct query {
    const char *id;
    size_t line; /* of its file; 0 = none */
    conus_pose pose;
    double angle;
    const double *range; /* NULL = --range */
    bool is_point;
    double point[3];
    double radius; /* of the ball; 0 = what is at the point */
    bool is_needle;
};

/* Adds what the axis passes in one atlas. */
static conus_status add_axis(const struct answerer *answerer, const struct query *query)
{
    conus_table *table = NULL;
    conus_status status = conus_segments(&table, answerer->selector, &query->pose);
    status = status ? status : conus_report_add_table(answerer->report, query->id, table);
    conus_table_destroy(table);
    return status;
}

/* Adds what the command line asks for of one atlas's answer to a query. */
static int add_answer(struct query_run *run, size_t index, const struct query *query, const conus_selection *selection)
{
    const struct query_settings *settings = run->settings;
    struct answerer *answerer = &run->request.answerers[index];
    bool is_shank = format_of(run->request.format)->is_of_probe && !query->is_point;
    run->has_points = run->has_points || query->is_point;
    run->has_cones = run->has_cones || !query->is_point;
    run->has_shanks = run->has_shanks || is_shank;
    const conus_result *result = conus_selection_result(selection, 0);
    if (!query->is_point && !is_shank && !(result && result->object)) {
        conus_pose_finding *empty = &answerer->empty;
        *empty = empty->count ? *empty
                              : (conus_pose_finding){.first = query->line, .pose = query->pose, .angle = query->angle};
        empty->count++;
    }
    for (size_t i = 0; !run->has_tracts && (result = conus_selection_result(selection, i)); i++) {
        run->has_tracts = result->kind == CONUS_KIND_PATHWAY || result->kind == CONUS_KIND_BUNDLE;
    }
    if (is_shank && settings->voxels) {
        return print_usage_error("--voxels: the shanks of a probe have none, other formats list those of cones");
    }
    double lead = 0;
    struct asked asked = {.line = query->line,
                          .pose = query->is_point ? NULL : &query->pose,
                          .lead = query->is_needle && index == 0 ? &lead : NULL,
                          .selection = selection,
                          .radius = ends_radius_of(&settings->ends, run->request.arguments),
                          .pairs = settings->ends.connectivity};
    conus_status status =
        is_shank ? add_axis(answerer, query) : conus_report_add(answerer->report, query->id, selection);
    status = status ? status : rows_files_add(&run->request.rows, index, answerer->selector, query->id, &asked);
    if (lead > 0 && !run->leads++) {
        run->first_lead = query->line;
        run->lead = lead;
    }
    return print_status(status);
}

/* Asks all atlases. Where the query itself is wrong, it sets *fault and prints nothing: the caller says so. */
static int ask_atlases(struct query_run *run, const struct query *query, bool *fault)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < run->request.atlases.count && !code; i++) {
        conus_selector *selector = run->request.answerers[i].selector;
        conus_selection *selection = NULL;
        conus_status status = conus_selector_set_range(selector, query->range);
        status = status            ? status
                 : query->is_point ? conus_select_ball(&selection, selector, query->point, query->radius)
                                   : conus_select(&selection, selector, &query->pose, query->angle);
        *fault = status == CONUS_ERROR_ARGUMENT && i == 0;
        if (*fault) {
            return EXIT_DONE;
        }
        code = status ? print_status(status) : add_answer(run, i, query, selection);
        code = code ? code : selection_files_take(&run->files, selection, run->request.atlases.items[i].atlas);
        conus_selection_destroy(selection);
    }
    return code;
}

static int answer_row(void *user, const conus_pose_row *row)
{
    struct query_run *run = user;
    struct request *request = &run->request;
    double radius =
        settings_point_radius(&request->settings->engine, row, run->probe || format_of(request->format)->is_foreign);
    char why[256] = "";
    if (row->is_point && !run->probe) {
        settings_point_error(why, &request->settings->engine, request->arguments);
    }
    struct query query = {.id = row->id,
                          .line = row->line,
                          .pose = row->pose,
                          .range = row->range,
                          .is_point = row->is_point,
                          .radius = radius};
    bool fault = false;
    if (run->insertions) {
        size_t index = conus_probe_at(run->probe, request->row)->index;
        request_mark(request, index, conus_pose_list_row(run->insertions, index));
    }
    if (row->error || why[0]) {
        return request_refuse_row(request, row, row->error ? row->error : why);
    }
    if (row->is_point) {
        memcpy(query.point, row->pose.world_from_device + 12, sizeof query.point);
        request_count_point(request, row->line, query.point, radius);
    } else {
        query.angle = request_angle(request, row);
        query.is_needle = row->angle == 0 && row->range[1] > 0;
        run->has_needles = run->has_needles || query.is_needle;
        request_count_pose(request, row->line, &row->pose, query.angle);
    }
    int code = ask_atlases(run, &query, &fault);
    return fault ? request_refuse_row(request, row, conus_message()) : code;
}

/* Names the object that is nearest to a point outside of the box around the first atlas's objects, unless the object
 * is in the ball that was asked for, or the answer itself and not far away; and what the numbers may be instead. */
static void say_nearest(const struct query_run *run, const struct query *query)
{
    const struct request *request = &run->request;
    const conus_atlas *atlas = request->atlases.items[0].atlas;
    conus_selection *selection = NULL;
    conus_frame ccf;
    double low[3];
    double high[3];
    double p[3];
    bool is_outside = false;
    if (conus_atlas_bounds(low, high, atlas)) {
        return;
    }
    for (int a = 0; a < 3; a++) {
        is_outside = is_outside || query->point[a] < low[a] || query->point[a] > high[a];
    }
    if (!is_outside || conus_select_ball(&selection, request->answerers[0].selector, query->point, 0)) {
        return;
    }
    conus_frame_from_world(p, &request->frame, query->point);
    bool is_above = request->frame.space == CONUS_SPACE_BREGMA && p[2] > 0;
    const conus_result *nearest = conus_selection_result(selection, 0);
    double longest = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
    bool is_far = nearest && (nearest->distance > longest / 4 || is_above);
    bool is_other =
        is_far && request->frame.space < CONUS_SPACE_CCF && !conus_frame_find(&ccf, atlas, CONUS_SPACE_CCF, NULL);
    if (nearest && nearest->distance > query->radius && (query->radius > 0 || is_far)) {
        say_note(is_far ? CONUS_SEVERITY_WARNING : CONUS_SEVERITY_NOTE, run->settings->request.common.quiet,
                 "the point lies outside of the atlas; the nearest to it is %s, %.2f mm away%s",
                 conus_atlas_object(atlas, nearest->object)->name, nearest->distance,
                 is_above   ? "; DV is up from bregma, so that depths are negative"
                 : is_other ? "; --space ccf takes AP,DV,ML in micrometres, --space bregma AP,ML,DV in mm"
                            : "");
    }
    conus_selection_destroy(selection);
}

/* The places of --point. Those are found in the first atlas. */
static int find_points(struct query_run *run)
{
    const struct option_list *points = &run->settings->points;
    const struct option *of_one = option_with(run->request.arguments, OPTION_OF_ONE_POSE);
    int code = EXIT_DONE;
    run->points = calloc(points->count ? points->count : 1, sizeof *run->points);
    if (!run->points) {
        return print_no_memory();
    }
    if (of_one && points->count > 1) {
        return print_usage_error("--%s shows one pose, --point is given %zu times", of_one->name, points->count);
    }
    for (size_t i = 0; i < points->count && !code; i++) {
        code = named_places_find(run->points[i], &run->request.places, "point", points->items[i], NULL);
    }
    return code;
}

static int answer_points(struct query_run *run)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < run->settings->points.count && !code; i++) {
        char id[24];
        struct query query = {.id = id, .is_point = true, .radius = run->request.settings->engine.radius};
        bool fault = false;
        snprintf(id, sizeof id, "%zu", i + 1);
        memcpy(query.point, run->points[i], sizeof query.point);
        code = ask_atlases(run, &query, &fault);
        code = fault ? print_status(CONUS_ERROR_ARGUMENT) : code;
        if (!code) {
            say_nearest(run, &query);
        }
    }
    return code;
}

static int answer_one(struct query_run *run)
{
    struct request *request = &run->request;
    const struct request_settings *settings = request->settings;
    double range[2];
    struct query query = {.id = "1", .pose = request->aim, .range = range};
    bool fault = false;
    if (run->settings->points.count) {
        return answer_points(run);
    }
    int code = settings_pose_cone(&query.angle, range, request->aim_target, &settings->aim, &settings->engine);
    if (code) {
        return code;
    }
    request_count_pose(request, 1, &query.pose, query.angle);
    code = ask_atlases(run, &query, &fault);
    return fault ? print_status(CONUS_ERROR_ARGUMENT) : code;
}

static conus_status start_query(struct query_run *run)
{
    const struct query_settings *settings = run->settings;
    struct request *request = &run->request;
    conus_selector_options engine =
        settings_engine(&settings->request.engine, &settings->request.aim, &settings->request.common);
    if (option_given(request->arguments, "point")) {
        engine.radius = 0; /* of the ball */
        engine.layers = CONUS_LAYERS_ALL;
    }
    if (run->probe) {
        engine.range[0] = engine.range[1] = 0; /* of the shanks */
    }
    conus_status status = request_start(request, &engine);
    if (status) {
        return status;
    }
    conus_report_options report = request_report_options(request);
    report.all_voxels = settings->voxels_of == 1;
    report.no_voxels = !settings->voxels;
    report.order = (conus_order)settings->axis.order;
    report.radii = run->has_radii;
    report.points = option_given(request->arguments, "point") || (run->is_of_points && !run->probe);
    report.contacts = run->contacts;
    report.probe = run->probe;
    report.placed = settings->coordsystem;
    report.electrodes = format_is(request->format, "bids") ? conus_pose_list_facts(request->poses).electrodes : NULL;
    return request_reports(request, &report);
}

/* Writes one of the report's further tables, unless `path` is NULL. */
static int write_table(const char *path, conus_report *report,
                       conus_status (*table)(const char **text, size_t *size, conus_report *report))
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = path ? table(&text, &size, report) : CONUS_OK;
    return status || !text ? print_status(status) : output_write(path, text, size);
}

/* Says how many streamlines --streamlines-out wrote: areas may hide them in the answer. */
static int say_streamlines(const struct query_run *run)
{
    conus_table *tractograms = NULL;
    int64_t total = 0;
    if (!run->files.streamlines) {
        return EXIT_DONE;
    }
    conus_status status = conus_atlas_list(&tractograms, run->request.atlases.items[0].atlas, "tractograms");
    for (size_t i = 0; i < conus_table_rows(tractograms); i++) {
        total += conus_table_counts(tractograms, "streamlines")[i];
    }
    conus_table_destroy(tractograms);
    say_note(CONUS_SEVERITY_NOTE, run->settings->request.common.quiet,
             "%s: %zu of %" PRId64 " streamlines written: all that come in, also behind areas",
             run->settings->files.streamlines, conus_streamline_list_data(run->files.streamlines).count, total);
    return print_status(status);
}

/* The answer is written last: where it is, all other files are there, too. */
static int write_all(struct query_run *run)
{
    const struct query_settings *settings = run->settings;
    const struct request *request = &run->request;
    conus_report *report = request->answerers[0].report;
    struct provenance provenance = {0};
    int code = write_table(settings->voxels, report, conus_report_voxels);
    code = code ? code : write_table(settings->probes, report, conus_report_probes);
    code = code ? code : write_table(settings->coordsystem, report, conus_report_coordsystem);
    if (code) {
        return code;
    }
    request_list_inputs(&provenance, request);
    provenance_add_input(&provenance, settings->probe.path);
    if (run->has_points && !run->has_cones) {
        provenance.question.region = "ball";
    }
    code = rows_files_write(&request->rows, &provenance);
    if (run->has_shanks) {
        provenance.question.rows = "segments";
        provenance.question.region = "axis";
    }
    code = code ? code : selection_files_write(&run->files, report, &provenance);
    code = code ? code : say_streamlines(run);
    return code ? code : request_write_answer(request, &provenance);
}

/* Whether --voxels has something to list. */
static bool check_voxels(const struct query_run *run)
{
    bool has_points = run->settings->request.engine.layers || option_given(run->request.arguments, "point");
    bool has_some = !run->settings->voxels || run->settings->voxels_of;
    for (size_t i = 0; i < run->request.atlases.count; i++) {
        const conus_atlas *atlas = run->request.atlases.items[i].atlas;
        for (uint32_t number = 1; number <= conus_atlas_object_count(atlas) && !has_some; number++) {
            conus_kind kind = conus_atlas_object(atlas, number)->kind;
            has_some = kind == CONUS_KIND_PATHWAY || (kind == CONUS_KIND_BUNDLE && has_points);
        }
    }
    if (!has_some) {
        print_error_line(
            "--voxels lists the voxels of pathways, and there is none; --pathway adds one, --voxels-of all "
            "the areas', --layers all the points of bundles");
    }
    return has_some;
}

/* Says where the tip is and how the probe is turned, which the file of poses alone does not show. */
static void say_probe(const struct query_run *run, const conus_pose *poses)
{
    size_t first = 0; /* contact of the probe */
    for (size_t i = 0; i < conus_probe_count(run->probe) && !run->settings->request.common.quiet; i++) {
        double tip[3];
        double across[3];
        conus_probe_tip(tip, run->probe, i);
        conus_frame_direction_from_world(across, &run->request.frame, poses[i].world_from_device);
        for (int a = 0; a < 3; a++) {
            across[a] = round(1000 * across[a]) / 1000 + 0; /* no -0 */
        }
        while (conus_probe_at(run->probe, first)->index < i) {
            first++;
        }
        say_note(CONUS_SEVERITY_NOTE, false, "%s: %s: the tip is at x %g, y %g um; %sits x axis points along %g,%g,%g",
                 run->settings->probe.path, conus_probe_at(run->probe, first)->probe, tip[0], tip[1],
                 run->settings->probe.roll != 0 ? "without the roll, " : "", across[0], across[1], across[2]);
    }
}

/* Moves a pose along its axis, to the far end of its own range or of --range, where there is one. */
static void go_to_far_end(conus_pose *pose, double own, const struct query_run *run)
{
    double far = own >= 0 ? own : run->settings->request.engine.range.ends[1];
    for (int a = 0; a < 3; a++) {
        pose->world_from_device[12 + a] -= far * pose->world_from_device[8 + a];
    }
}

/* The poses of the probes' tips: of a file, or that of the options. */
static int find_poses(conus_pose *out, size_t count, const struct query_run *run)
{
    const struct request *request = &run->request;
    const conus_pose_list *poses = request->poses;
    size_t found = poses ? conus_pose_list_count(poses) : 1;
    if (found != count) {
        return print_data_error("%s: found %zu poses, wanted are %zu: each probe of %s has one of its own",
                                poses ? pose_settings_file_name(request->settings->aim.pose) : "--origin", found, count,
                                run->settings->probe.path);
    }
    for (size_t i = 0; i < count && poses; i++) {
        const conus_pose_row *row = conus_pose_list_row(poses, i);
        if (row->error || row->is_point) {
            return print_data_error("%s:%zu: %s", pose_settings_file_name(request->settings->aim.pose), row->line,
                                    row->error ? row->error : "a point, without the direction that a probe needs");
        }
        out[i] = row->pose;
        go_to_far_end(&out[i], row->range[1], run);
    }
    if (!poses) {
        double angle;
        double range[2];
        int code =
            settings_pose_cone(&angle, range, request->aim_target, &request->settings->aim, &request->settings->engine);
        *out = request->aim;
        go_to_far_end(out, range[1], run);
        return code;
    }
    return EXIT_DONE;
}

/* Of a file of one probe and several poses, makes as many probes, called as the poses. */
static int repeat_probe(struct query_run *run)
{
    const conus_pose_list *poses = run->request.poses;
    size_t count = conus_pose_list_count(poses);
    if (conus_probe_count(run->probe) != 1 || count < 2) {
        return EXIT_DONE;
    }
    conus_probe *several = NULL;
    const char **names = calloc(count, sizeof *names);
    if (!names) {
        return print_no_memory();
    }
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && !code; i++) {
        names[i] = conus_pose_list_row(poses, i)->id;
        for (size_t k = 0; k < i && !code; k++) {
            bool is_same = strcmp(names[k], names[i]) == 0;
            code =
                is_same
                    ? print_data_error("%s: poses %zu and %zu are both called \"%s\": the probes that they place "
                                       "have names of their own",
                                       pose_settings_file_name(run->request.settings->aim.pose), k + 1, i + 1, names[i])
                    : EXIT_DONE;
        }
    }
    code = code ? code : print_status(conus_probe_repeat(&several, run->probe, names, count));
    free(names);
    if (!code) {
        conus_probe_destroy(run->probe);
        run->probe = several;
    }
    return code;
}

/* Puts the contacts of --probe in the place of the poses. */
static int place_probe(struct query_run *run)
{
    struct request *request = &run->request;
    conus_pose_list *contacts = NULL;
    int code = repeat_probe(run);
    size_t count = conus_probe_count(run->probe);
    conus_pose *poses = run->probe && !code ? calloc(count, sizeof *poses) : NULL;
    if (code || !run->probe || !poses) {
        return code || !run->probe ? code : print_no_memory();
    }
    code = find_poses(poses, count, run);
    conus_status status =
        code ? CONUS_OK : conus_probe_place(&contacts, run->probe, poses, count, run->settings->probe.roll);
    if (!code && !status) {
        say_probe(run, poses);
        run->insertions = request->poses;
        request->poses = contacts;
        request->rows_of = run->settings->probe.path;
    }
    free(poses);
    return status ? print_status(status) : code;
}

static int load_poses(void *user)
{
    struct query_run *run = user;
    struct request *request = &run->request;
    const char *poses = request->settings->aim.pose;
    int code = probe_settings_load(&run->probe, &run->settings->probe, request->settings->atlas.max_memory);
    code = code ? code : request_load_poses(request);
    if (!code && poses) {
        code = check_poses(run);
    }
    return code ? code
                : pose_settings_check_electrodes(request->format, conus_pose_list_facts(request->poses).electrodes,
                                                 poses);
}

static int answer_query(struct query_run *run)
{
    struct request *request = &run->request;
    int code = request_load(request, load_poses, run);
    if (code) {
        return code;
    }
    bool has_ends = run->settings->ends.endpoints || run->settings->ends.connectivity;
    bool is_of_points = option_given(request->arguments, "point") || run->is_of_points;
    bool is_plain_point = is_of_points && !run->probe && request->settings->engine.radius == 0 && !run->has_radii;
    const struct option *near = is_plain_point ? option_with(request->arguments, OPTION_OF_REGION) : NULL;
    if (near) {
        return print_usage_error("--%s needs --radius MM: it is about what is near a point", near->name);
    }
    if (!check_voxels(run) || (has_ends && !ends_check_atlases(&request->atlases))) {
        return EXIT_USAGE;
    }
    code = request_check_outputs(request);
    code = code ? code : request_match(request);
    code = code ? code : request_find_aim(request);
    code = code ? code : find_points(run);
    code = code ? code : place_probe(run);
    code = code ? code
                : settings_understood(run->understood, &request->places, &request->settings->aim,
                                      &request->settings->engine, run->is_of_points && !run->probe, run->has_radii,
                                      conus_pose_list_facts(request->poses).space);
    if (code) {
        return code;
    }
    conus_status status = start_query(run);
    code = status           ? print_status(status)
           : request->poses ? request_each_row(request, answer_row, run)
                            : answer_one(run);
    if (code) {
        return code;
    }
    request_say_notes(request);
    settings_say_weight(&request->settings->aim, &request->settings->engine, &request->settings->common,
                        request->atlases.items[0].atlas);
    atlases_say_open(&request->atlases, &request->settings->engine, &request->settings->common);
    request_say_aims(request);
    bool are_added = option_given(request->arguments, "streamlines") || option_given(request->arguments, "pathway");
    const struct axis_settings *axis = &run->settings->axis;
    are_added = are_added && !axis->segments && !axis->clearance; /* which have all that an axis passes */
    if (are_added && run->has_cones && !run->has_tracts && request->settings->engine.layers == CONUS_LAYERS_VISIBLE) {
        say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet,
                 "no bundle or pathway is seen; areas may hide them: --layers all has all that a cone passes");
    }
    char asked[256];
    settings_point_error(asked, &request->settings->engine, request->arguments);
    const struct engine_settings *engine = &request->settings->engine;
    bool shows_all = engine->layers != CONUS_LAYERS_VISIBLE || axis->segments || axis->clearance || run->probe;
    if (run->has_needles && engine->radius == 0 && !asked[0]) {
        say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet,
                 "axes that end at a target or a depth are asked as cones of %g degrees: --radius MM --layers all asks "
                 "what a needle of that width passes, --segments FILE what the axis passes, in order",
                 settings_angle(&request->settings->aim, engine));
    } else if (run->has_needles && engine->radius > 0 && !shows_all) {
        say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet,
                 "needles are asked for what they meet first: --layers all asks what they pass, --segments FILE what "
                 "the axis passes, in order");
    }
    bool is_endless = (axis->segments || axis->clearance) && run->has_cones && !run->has_needles && !run->probe &&
                      option_given(request->arguments, "pose") && !option_given(request->arguments, "range");
    say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet || !is_endless,
             "axes without an end go on behind their targets: --range 0,target ends them there, --range 0,MM at a "
             "depth");
    say_note(CONUS_SEVERITY_NOTE, request->settings->common.quiet || !run->leads,
             "%zu ax%s outside of the atlas's objects (the first in line %zu, %.2f mm before one): depths are from the "
             "position of a pose, not from the surface",
             run->leads, run->leads == 1 ? "is begins" : "es begin", run->first_lead, run->lead);
    return request_code(request, write_all(run));
}

static int start_outputs(struct query_run *run)
{
    const struct query_settings *settings = run->settings;
    struct request *request = &run->request;
    int code = selection_files_init(&run->files, &request->outputs, &settings->files, request->arguments);
    code = code ? code : settings_contacts(&run->contacts, settings->axis.contacts);
    if (!code && request->rows.replace && settings->axis.order) {
        code = print_usage_error("--order has no effect without the answer: other rows have but one order");
    }
    if (code) {
        return code;
    }
    return check_format(request, settings) && outputs_differ(&request->outputs) ? EXIT_DONE : EXIT_USAGE;
}

static int ask(const struct query_settings *settings, const struct arguments *arguments)
{
    bool fits = option_given(arguments, "point")
                    ? space_settings_check(arguments, &settings->request.aim.space)
                    : request_check(&settings->request, arguments, false) && settings_check_aim(arguments, true);
    if (!fits || !check_outputs(settings, arguments)) {
        return EXIT_USAGE;
    }
    struct query_run run = {.settings = settings};
    int code = request_init(&run.request, &settings->request, arguments);
    code = code ? code : keep_settings_names(&run.kept, &settings->keep);
    run.request.kept = &run.kept;
    code = code ? code : start_outputs(&run);
    code = code ? code : answer_query(&run);
    selection_files_finish(&run.files);
    free(run.points);
    request_finish(&run.request);
    conus_probe_destroy(run.probe);
    conus_pose_list_destroy(run.insertions);
    return code;
}

static int run_query(const void *given, const struct arguments *arguments)
{
    struct query_settings settings = *(const struct query_settings *)given;
    int code = settings_weight(&settings.request.aim, &settings.request.engine, arguments);
    code = code ? code : ask(&settings, arguments);
    settings_weight_finish(&settings.request.engine);
    return code;
}

const struct command cmd_query = {
    .name = "query",
    .summary = "list the areas, pathways and bundles in a cone, with shares and contact positions",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "(--origin PLACE (--toward PLACE | --direction X,Y,Z) | --point PLACE | --pose FILE)",
    .description =
        "Traces N x N rays from a device's position into the atlas and reports every area, pathway and bundle that a\n"
        "ray hits first: its share of the cone, its pixels, its nearest contact and where it is, in mm.\n"
        "With --layers all it reports all hits in the cone, occluded or not; with --point it reports the\n"
        "objects within --radius mm of a point.",
    .examples = "  conus query aal.nii.gz --origin -90,20,20 --toward Hippocampus_L --angle 20\n"
                "  conus query aal.nii.gz --point \"left hippocampus\" --radius 5\n"
                "  conus query aal.nii.gz --pose poses.tsv --angle 5 -o answers.tsv\n"
                "  conus query aal.nii.gz --origin 0,0,90 --direction 0,0,-1 --image seen.exr --format json\n",
    .see_also = "  conus batch     many poses: in parallel, in bounded memory\n"
                "  conus sweep     how certain an answer is (uncertain: --jitter), and from which angle on\n"
                "  conus render    figures of the brain and the cone, in colour (color)\n"
                "  conus overlap   how much of each area (region) a lesion or a mask covers\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct query_settings),
    .more_help = help_scores,
    .run = run_query,
};
