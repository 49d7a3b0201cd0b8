/* SPDX-License-Identifier: BSD-3-Clause */
/* conus plan: which poses reach some structures and stay clear of others, and how far they may be off. */
#include "cli/cmd_plan.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(member) OPTION_AT(struct plan_settings, member)

static const struct option jitter_options[] = {
    {OPTION_VALUED("jitter", struct plan_settings, jitter, "DEGREES,MM|entry=MM,target=MM[,depth=MM]|NAME"),
     .help = "report how probable it is that the listed poses break nothing, and hold each constraint, under normal "
             "errors: standard deviations of the axis's tilt about two axes and of the position along three, or of the "
             "device's position and the far end along two directions across the axis, and of the depth; or NAME, a "
             "published error, below",
     .words = "uncertain, uncertainty, probability, accuracy, p_ok", .role = OPTION_ASKS},
    {OPTION_VALUED("samples", struct plan_settings, samples, "N"),
     .help = "with --jitter: number of poses with errors, a power of two from 16 to 1048576",
     .standard = OPTION_DIGITS(JITTER_SAMPLES), OPTION_FROM_TO(16, 1048576), .needs = "jitter"},
    {0},
};

static const struct option list_options[] = {
    {OPTION_VALUED("top", struct plan_settings, top, "N|all"),
     .help = "list the best N poses; of --needles the best N combinations, 1 to 100, 1 unless given, with --diverse",
     .standard = "20", .words = "best, limit", .role = OPTION_ASKS},
    {OPTION_VALUED("rank", struct plan_settings, rank, "KEY[/STEP],..."),
     .help = "order of the list: the larger key first, of -KEY the smaller; a later key decides between equal ones, "
             "with /STEP between those in one step",
     .standard = "leeway,-depth", .words = "sort", .role = OPTION_ASKS},
    {OPTION_VALUED("score", struct plan_settings, score, "FORMULA"),
     .help = "formula of keys, numbers, + - * / and parentheses, which is the key score", .role = OPTION_ASKS},
    {OPTION_NAMED("infeasible", struct plan_settings, infeasible),
     .help = "list poses that break a constraint, too, behind the others, with what they break"},
    {OPTION_VALUED("poses-out", struct plan_settings, poses_out, "FILE"),
     .help = "write the listed poses: a table (.tsv) that is read as the same poses again, lines for 3D Slicer "
             "(.mrk.json) or as --streamlines of conus render (.vtk), or the first one as a 4 x 4 matrix (.txt)",
     .words = "export, slicer, paraview", .endings = ".tsv .mrk.json .vtk .txt", OPTION_WRITING(POSES)},
    {0},
};

static const struct option best_map_options[] = {
    {OPTION_VALUED("map", struct plan_settings, map, "FILE[,fill=nearest]"),
     .help =
         "with entries from a surface (.func.gii, .shape.gii) or a mask (.nii.gz): write of each entry's best pose "
         "leeway_mm, slack_mm, depth_mm, entry_angle_deg, reach1_mm and candidate, and how many poses are feasible; "
         "with fill vertices that the spacing leaves out have the numbers of the nearest entry",
     .words = "scalp, overlay, func.gii, colours", .needs = "from", .endings = ".func.gii .shape.gii .nii.gz .nii",
     .keys = KEYS_VERTEX_MAP, OPTION_WRITING(SURFACE)},
    {OPTION_VALUED("target-map", struct plan_settings, target_map, "FILE"),
     .help = "with --toward voxels: write of each target voxel how many poses are feasible, and the leeway_mm of the "
             "best one",
     .words = "overlay, nifti", .needs = "toward", .endings = ".nii.gz .nii", OPTION_WRITING(VOLUME)},
    {OPTION_VALUED("structure", struct plan_settings, structure, "NAME"),
     .help = "what the surface of --map is for Workbench, CortexLeft say", .otherwise = "as its file says",
     .needs = "map", .role = OPTION_ASKS},
    {0},
};

static const struct option rows_options[] = {
    {OPTION_VALUED("constraints", struct plan_settings, constraint_rows, "FILE"),
     .help = "write a row for each listed pose and constraint: what was measured, the limit, the slack",
     .role = OPTION_WRITES_ROWS, .holds = HOLDS_ROWS},
    {OPTION_VALUED("profile", struct plan_settings, profile, "FILE[,step=MM]"),
     .help = "write how far each listed needle is from what it is to avoid, at every MM of depth (default 1)",
     .words = "curve, distance", .role = OPTION_WRITES_ROWS, .keys = KEYS_PROFILE, .holds = HOLDS_ROWS},
    {OPTION_VALUED("tolerance", struct plan_settings, tolerance, "FILE"),
     .help = "write by how much each listed pose may be off along each degree of freedom before a constraint breaks",
     .words = "deviation, robustness, degrees of freedom", .role = OPTION_WRITES_ROWS, .holds = HOLDS_ROWS},
    {OPTION_VALUED("pivot", struct plan_settings, pivot, "entry|tip|MM"),
     .help = "what the needle turns about there: the device's position, the far end, or a depth", .standard = "entry",
     .role = OPTION_ASKS, .needs = "tolerance"},
    {0},
};

static const struct option run_options[] = {
    {OPTION_VALUED("threads", struct plan_settings, threads, "N"),
     .help = "number of threads, 1 to 1024; the answer does not depend on it",
     .otherwise = "one per available processor", OPTION_FROM_TO(1, 1024), .words = "parallel, cores",
     .role = OPTION_KEPT},
    {OPTION_VALUED("progress", struct plan_settings, progress, "KIND"),
     .help = "on standard error: a line on a terminal, JSON for programs, or nothing:", .choices = progress_kinds,
     .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Which poses are tried", plan_pose_options, 0},
    {"", candidate_options, offsetof(struct plan_settings, candidates)},
    {"", plan_needle_options, 0},
    {"", scalp_options, REQUEST_FIELD(aim)},
    {"", pose_file_options, REQUEST_FIELD(file)},
    {"", space_options, REQUEST_FIELD(aim.space)},
    {"What must hold, all of it", constraint_options, offsetof(struct plan_settings, constraints)},
    {"", entry_options, offsetof(struct plan_settings, constraints)},
    {"", plan_contact_options, 0},
    {"", shank_options, offsetof(struct plan_settings, constraints)},
    {"Several needles together", needles_options, offsetof(struct plan_settings, needles)},
    {"", part_options, offsetof(struct plan_settings, needles)},
    {"Measures of the cone", angle_options, REQUEST_FIELD(aim)},
    {"", ray_options, REQUEST_FIELD(engine.numbers)},
    {"", pixel_options, REQUEST_FIELD(engine)},
    {"What is listed", list_options, 0},
    {"", jitter_options, 0},
    {"What is there", atlas_options, REQUEST_FIELD(atlas)},
    {"", side_options, REQUEST_FIELD(atlas)},
    {"", shown_options, REQUEST_FIELD(atlas)},
    REQUEST_OUTPUT_GROUPS,
    {"", best_map_options, 0},
    {"", rows_options, 0},
    {"How it runs", run_options, 0},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/** A plan under way. */
struct planning {
    const struct plan_settings *settings;
    struct request request;
    struct constraints constraints;
    struct candidates candidates;
    uint64_t top;
    conus_tolerance_options pivot;
    conus_jitter_options jitter;
    double step; /* mm, of --profile */
    conus_plan *plan;
    bool has_said_time; /* how long it takes */
};

static bool read_top(uint64_t *out, const char *text)
{
    *out = text && strcmp(text, "all") == 0 ? UINT64_MAX : 0;
    bool is_fine = !text || *out || (count_parse(text, UINT64_MAX, out) && *out > 0);
    return is_fine || refuse("--top: \"%s\" is neither a whole number above 0 nor all", text);
}

static bool read_pivot(conus_tolerance_options *out, const char *text)
{
    *out = (conus_tolerance_options)CONUS_TOLERANCE_OPTIONS_INIT;
    out->pivot_at_tip = text && strcmp(text, "tip") == 0;
    bool is_fine = !text || out->pivot_at_tip || strcmp(text, "entry") == 0 || number_parse(text, &out->pivot);
    return is_fine || refuse("--pivot: \"%s\" is neither a number nor entry nor tip", text);
}

static bool has_avoided(const struct constraints *constraints)
{
    bool found = false;
    for (size_t i = 0; i < constraints->count; i++) {
        found = found || (constraints->items[i].kind == CONUS_CONSTRAINT_AVOID && !constraints->items[i].measure);
    }
    return found;
}

static int open_poses(void *user)
{
    struct request *request = user;
    const conus_pose_options options = request_pose_options(request);
    const char *path = request->settings->aim.pose;
    if (!path) { /* candidates, which need the atlas */
        return EXIT_DONE;
    }
    conus_status status = conus_pose_stream_open(&request->stream, path, &options);
    return status ? pose_settings_print_error(status, path, "poses", request->arguments) : EXIT_DONE;
}

/* Says after the first second how long a plan of minutes will take. */
static void say_time(struct planning *planning, uint64_t done)
{
    static const double SECOND = 1000, LONG = 120 * SECOND;
    const struct progress *progress = &planning->request.progress;
    double spent = clock_ms() - progress->started;
    if (planning->has_said_time || spent < SECOND || !progress->total || !done) {
        return;
    }
    planning->has_said_time = true;
    double all = spent / (double)done * (double)progress->total;
    if (all > LONG) {
        bool is_of_hours = all > 7200 * SECOND;
        say_note(CONUS_SEVERITY_NOTE, planning->settings->request.common.quiet,
                 "%llu poses take about %.2g %s; Ctrl-C lists the best of those that were tried",
                 (unsigned long long)progress->total, all / SECOND / (is_of_hours ? 3600 : 60),
                 is_of_hours ? "hours" : "minutes");
    }
}

static bool show_tried(void *user, size_t done, size_t total)
{
    struct planning *planning = user;
    (void)total;
    progress_update(&planning->request.progress, done, 0);
    say_time(planning, done);
    return !interrupt_signal();
}

static void list_inputs(struct provenance *out, const struct planning *planning)
{
    request_list_inputs(out, &planning->request);
    for (size_t i = 0; i < planning->constraints.count; i++) {
        bool has_file = planning->constraints.items[i].kind == CONUS_CONSTRAINT_APART;
        provenance_add_input(out, has_file ? planning->constraints.texts[i] : NULL);
    }
    candidates_list_inputs(out, &planning->candidates);
}

/* A run that a signal ended has a list, too: of the poses that were tried. */
static int say_cut(struct planning *planning, int signal)
{
    struct request *request = &planning->request;
    uint64_t rows = conus_plan_left(planning->plan, 0) + conus_plan_rejected(planning->plan).count;
    uint64_t total = 0;
    char of[32] = "";
    if (!rows) {
        print_error_line("interrupted before the first pose");
        return 128 + signal;
    }
    if (!conus_pose_stream_count(&total, request->stream)) {
        if (rows == total) { /* it came too late */
            return EXIT_DONE;
        }
        snprintf(of, sizeof of, " of %llu", (unsigned long long)total);
    }
    say_warning("interrupted: tried %llu%s poses; the list has the best of these", (unsigned long long)rows, of);
    request->failed = true;
    return EXIT_DONE;
}

static int run_all(struct planning *planning)
{
    struct request *request = &planning->request;
    conus_plan *plan = planning->plan;
    interrupt_catch(request->stream);
    conus_status status = conus_plan_run(plan, request->stream, UINT64_MAX);
    interrupt_release();
    int signal = interrupt_signal();
    status = status == CONUS_ERROR_CANCELLED && signal ? conus_plan_cut(plan) : status;
    progress_finish(&request->progress, conus_plan_left(plan, 0), conus_plan_rejected(plan).count);
    return status ? print_status(status) : signal ? say_cut(planning, signal) : EXIT_DONE;
}

static int try_poses(struct planning *planning)
{
    const struct plan_settings *settings = planning->settings;
    struct request *request = &planning->request;
    struct progress *progress = &request->progress;
    const conus_plan_options options = {
        .threads = settings->threads,
        .top = planning->top,
        .infeasible = settings->infeasible,
        .rank = settings->rank,
        .score = settings->score,
        .angle = settings_angle(&settings->request.aim, &settings->request.engine),
        .far = planning->candidates.far,
        .entries = settings->map ? conus_sites_count(planning->candidates.from.sites) : 0,
        .jitter = settings->jitter ? &planning->jitter : NULL,
        .targets = settings->target_map ? conus_sites_count(planning->candidates.toward.sites) : 0,
        .shanks = planning->constraints.shanks,
        .shank_count = planning->constraints.shank_count,
        .progress = show_tried,
        .progress_user = planning,
    };
    conus_status status = conus_plan_create(&planning->plan, request->answerers[0].selector,
                                            planning->constraints.items, planning->constraints.count, &options);
    if (status) {
        return print_status(status);
    }
    progress_start(progress, (enum progress_kind)settings->progress, settings->request.common.quiet, "poses", 0);
    bool is_quick = !settings->request.aim.pose; /* candidates are counted without being made */
    if (!(is_quick || progress_is_shown(progress)) || conus_pose_stream_count(&progress->total, request->stream)) {
        progress->total = 0;
    }
    return run_all(planning);
}

/* Rows that are no candidates; without any candidate there is nothing to plan. */
static int check_candidates(struct planning *planning)
{
    struct request *request = &planning->request;
    pose_settings_say_late(request->stream, request->settings->aim.pose, request->notes_said,
                           &request->settings->common);
    return plan_check_candidates(&request->failed, planning->plan, planning->settings, &planning->candidates);
}

static conus_status make_reports(struct planning *planning)
{
    struct request *request = &planning->request;
    conus_report_options options = request_report_options(request);
    options.rows = "plan";
    conus_status status = request_report(request, 0, &options);
    status = status ? status : conus_report_add_plan(request->answerers[0].report, planning->plan);
    struct asked asked = {.plan = planning->plan, .step = planning->step, .pivot = planning->pivot};
    return status ? status : rows_files_add(&request->rows, 0, request->answerers[0].selector, NULL, &asked);
}

enum { REACH = 4, FEASIBLE, CANDIDATE, MAPS };
/* Columns of conus_plan_list(); the last two are whole. */
static const struct {
    const char *name;
    bool of_targets;
} map_kinds[MAPS] = {{"leeway_mm", true},         {"slack_mm", false}, {"depth_mm", false}, {"entry_angle_deg", false},
                     [REACH] = {"reach1", false}, {"feasible", true},  {"candidate", false}};

/* The column that the first --reach fills; "reach1" without one. */
static const char *reach_name(const struct constraints *constraints)
{
    static const char *const names[] = {
        [CONUS_MEASURE_LENGTH] = "reach1_mm",         [CONUS_MEASURE_TIP] = "reach1_tip",
        [CONUS_MEASURE_CROSSED] = "reach1_crossed",   [CONUS_MEASURE_SHARE] = "reach1_share",
        [CONUS_MEASURE_CONTACTS] = "reach1_contacts", [CONUS_MEASURE_PROBABILITY] = "reach1_probability",
        [CONUS_MEASURE_PIERCED] = "reach1_pierced",   [CONUS_MEASURE_VOLUME] = "reach1_mm3",
        [CONUS_MEASURE_FRACTION] = "reach1_fraction", [CONUS_MEASURE_STREAMLINES] = "reach1_streamlines"};
    for (size_t i = 0; i < constraints->count; i++) {
        const conus_constraint *item = &constraints->items[i];
        if (item->kind == CONUS_CONSTRAINT_REACH && (size_t)item->measure < sizeof names / sizeof names[0]) {
            return names[item->measure];
        }
    }
    return "reach1";
}

static int write_map(const struct planning *planning, const char *path, bool of_targets)
{
    const struct place *place = of_targets ? &planning->candidates.toward : &planning->candidates.from;
    conus_table *table = NULL;
    conus_status status = conus_plan_list(&table, planning->plan, of_targets ? "targets" : "entries");
    size_t count = conus_table_rows(table);
    float *values = calloc(CANDIDATE * count + 1, sizeof *values);
    conus_vertex_map maps[MAPS];
    size_t written = 0;
    status = status || values ? status : CONUS_ERROR_MEMORY;
    for (size_t k = 0; k < MAPS && !status; k++) {
        const char *name = map_kinds[k].name;
        const double *numbers = conus_table_numbers(table, name);
        const int64_t *counts = conus_table_counts(table, name);
        conus_vertex_map map = {.name = k == REACH ? reach_name(&planning->constraints) : name};
        if (k < CANDIDATE) {
            for (size_t i = 0; i < count; i++) {
                values[k * count + i] = numbers ? (float)numbers[i] : (float)counts[i];
            }
            map.values = values + k * count;
        } else {
            map.numbers = (const uint64_t *)counts;
        }
        if (map_kinds[k].of_targets || !of_targets) {
            maps[written++] = map;
        }
    }
    double fill = !of_targets && option_key(planning->request.arguments, "map") ? place->apart : 0;
    status = status ? status
                    : conus_sites_write_maps(path, place->sites, maps, written, planning->settings->structure, fill);
    free(values);
    conus_table_destroy(table);
    return print_status(status);
}

static int check_maps(const struct planning *planning)
{
    const struct place *from = &planning->candidates.from;
    const char *fill = option_key(planning->request.arguments, "map");
    const char *map = planning->settings->map;
    if (fill && !(from->apart > 0)) {
        return print_usage_error("--map: fill has no effect without spacing=MM of --from");
    }
    bool is_volume = map && (path_ends_in(map, ".nii") || path_ends_in(map, ".nii.gz"));
    bool has_voxels = conus_sites_have_voxels(from->sites);
    if (map && (is_volume ? !has_voxels : from->angles || !conus_sites_normals(from->sites))) {
        return print_usage_error("--map: %s is no %s", from->path,
                                 is_volume    ? "mask"
                                 : has_voxels ? "surface: a map of voxels ends in .nii.gz"
                                              : "surface");
    }
    if (is_volume && fill) {
        return print_usage_error("--map: fill is for surfaces");
    }
    return !planning->settings->target_map || conus_sites_have_voxels(planning->candidates.toward.sites)
               ? EXIT_DONE
               : print_usage_error("--target-map: the targets of --toward %s are not voxels of one volume",
                                   planning->candidates.toward.path);
}

static int write_poses(const struct planning *planning)
{
    size_t count = conus_plan_count(planning->plan);
    struct written_pose *poses = calloc(count + 1, sizeof *poses);
    for (size_t i = 0; i < count && poses; i++) {
        const conus_planned *pose = conus_plan_pose(planning->plan, i);
        poses[i] = (struct written_pose){.id = pose->id,
                                         .pose = pose,
                                         .shanks = planning->constraints.shanks,
                                         .shank_count = planning->constraints.shank_count};
    }
    int code = poses ? candidates_write(planning->settings->poses_out, poses, count, &planning->request.frame)
                     : print_no_memory();
    free(poses);
    return code;
}

static int write_all(struct planning *planning)
{
    struct request *request = &planning->request;
    const struct plan_settings *settings = planning->settings;
    struct provenance provenance = {0};
    conus_pose_error error;
    provenance.error = settings_error(&error, settings->jitter, true) ? &error : NULL;
    list_inputs(&provenance, planning);
    provenance.question.region = settings->request.engine.radius > 0                                       ? "cylinder"
                                 : constraints_last_measure(&planning->constraints) >= CONUS_MEASURE_SHARE ? "cone"
                                                                                                           : "axis";
    int code = rows_files_write(&request->rows, &provenance);
    if (!code && settings->poses_out) {
        code = write_poses(planning);
    }
    code = code || !settings->map ? code : write_map(planning, settings->map, false);
    code = code || !settings->target_map ? code : write_map(planning, settings->target_map, true);
    provenance.question.rows = "plan";
    return code ? code : request_write_answer(request, &provenance);
}

static int answer_plan(struct planning *planning)
{
    struct request *request = &planning->request;
    const struct plan_settings *settings = planning->settings;
    const conus_selector_options engine = plan_engine(settings, &planning->constraints);
    int code = request_load(request, open_poses, request);
    code = code ? code : request_match(request);
    const struct pose_places places = {&request->frame, &settings->request.file, &request->atlases,
                                       &settings->request.common};
    code = code ? code : constraints_place(&planning->constraints, &places, plan_far(settings, &planning->candidates));
    if (code) {
        return code;
    }
    conus_status status = request_start(request, &engine);
    code = print_status(status);
    if (!code && !request->stream) {
        code = candidates_open(&planning->candidates, request, &planning->constraints);
    }
    code = code ? code : check_maps(planning);
    code = code ? code : request_check_outputs(request); /* once all is read that a plan reads */
    code = code ? code : try_poses(planning);
    code = code ? code : check_candidates(planning);
    if (code) {
        return code;
    }
    status = make_reports(planning);
    if (status) {
        return print_status(status);
    }
    request_say_notes(request);
    if (!settings->request.common.quiet) {
        code = plan_say_funnel(planning->plan, settings->request.engine.radius);
        print_error_line("note: a plan is a list to be checked; conus is no medical device");
    }
    return request_code(request, code ? code : write_all(planning));
}

static int run_plan(const void *given, const struct arguments *arguments)
{
    const struct plan_settings *settings = given;
    if (settings->needles.file) {
        return plan_needles(settings, arguments);
    }
    struct planning planning = {.settings = settings, .step = option_key_number(arguments, "profile", 1)};
    int code = plan_parse(&planning.constraints, &planning.candidates, settings, arguments);
    bool fits = !code && read_top(&planning.top, settings->top) && read_pivot(&planning.pivot, settings->pivot) &&
                (!settings->jitter || settings_jitter(&planning.jitter, settings->jitter, settings->samples, true)) &&
                space_settings_check(arguments, &settings->request.aim.space);
    code = code || fits ? code : EXIT_USAGE;
    code = code ? code : request_init(&planning.request, &settings->request, arguments);
    if (!code && settings->profile && !has_avoided(&planning.constraints)) {
        code = print_usage_error("--profile has no effect without --avoid NAME,...");
    }
    code = code ? code : answer_plan(&planning);
    conus_plan_destroy(planning.plan);
    constraints_finish(&planning.constraints);
    request_finish(&planning.request);
    candidates_finish(&planning.candidates);
    return code;
}

static void help_keys(FILE *out)
{
    fputs("Keys of --rank and --score\n"
          "  leeway                      mm by which no point of the axis may be off before a constraint breaks\n"
          "  slack                       least clearance from what is avoided, less its margin, mm\n"
          "  clearance                   the same with the margin, mm\n"
          "  depth                       how deep the far end is, mm\n"
          "  entry_angle                 between the axis and the inward normal at the entry, degrees\n"
          "  reach, reach2, ...          what --reach measures, of the first one, the second one, ...\n"
          "  share, volume               what the first --reach with share or volume measures\n"
          "  p_ok                        probability to break nothing under --jitter, of all feasible poses\n"
          "  score                       the formula of --score\n\n",
          out);
    help_errors(out);
}

const struct command cmd_plan = {
    .name = "plan",
    .summary = "list the poses that reach some structures and stay clear of others, the safest first",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "--poses FILE|--from FILE --toward WHAT --reach NAME,...",
    .description =
        "Tries poses of a file, or needles from every entry to every target, against all constraints, and lists those\n"
        "that break none: how deep they are, how near they come to what they are to avoid and where, and their\n"
        "leeway, by which no point of the needle may be off before a constraint breaks. A plan is a list to be\n"
        "checked.",
    .examples = "  conus plan aal --poses needles.tsv --reach Hippocampus_L,length=5 --avoid Insula_L,margin=2\n"
                "  conus plan aal --from scalp.surf.gii,spacing=3 --toward voxels --depth target --reach Amygdala_L\n",
    .see_also = "  conus query --segments   what each needle passes\n"
                "  conus sweep --jitter     how certain an answer is when the pose is not exactly known\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct plan_settings),
    .more_help = help_keys,
    .run = run_plan,
};
