/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the candidates of a plan from entries and targets, and writes the poses that it lists. */
#include "cli/cmd_plan.h"

#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct option candidate_options[] = {
    {OPTION_VALUED("from", struct candidate_settings, from, "FILE,..."),
     .help = "or candidates from entries: vertices of a surface, voxels at the border of a mask, or points; keys: "
             "spacing=MM (of those nearer to each other the first), within=WHAT, without=WHAT (labels of vertices, a "
             "mask, or a structure of the atlas), flip (normals of the surface point to the other side); or "
             "angles,arc=FIRST:LAST:STEP,slider=FIRST:LAST:STEP,back=MM: MM from each target at these angles of a rig, "
             "degrees",
     .words = "entry, scalp, skull, craniotomy, grid", .common = true, .excludes = "poses", .needs = "toward|needles",
     OPTION_READING(SURFACE), .no_file = "angles"},
    {OPTION_VALUED("toward", struct candidate_settings, toward, "WHAT,..."),
     .help = "to targets: centroid, deepest (the voxel farthest from the border) or voxels of the first --reach; a "
             "FILE of points; or normal, against that of the surface; keys: of=NAME,... (another structure), "
             "spacing=MM",
     .words = "target", .common = true, .needs = "from|needles", .role = OPTION_READS_NAMES, .holds = HOLDS_POSES},
    {OPTION_VALUED("tilt", struct candidate_settings, tilt, "MAX,STEP"),
     .help = "and rings of directions around each, up to MAX degrees, STEP degrees apart", .needs = "from|needles",
     .role = OPTION_ASKS},
    {OPTION_VALUED("roll", struct candidate_settings, roll, "STEP"),
     .help = "and each turned about its axis, in steps of STEP degrees, 0.01 to 180", OPTION_FROM_TO(0.01, 180),
     .words = "turn, shanks, rotation", .needs = "from|needles", .role = OPTION_ASKS, .unit = "degrees"},
    {OPTION_VALUED("depth", struct candidate_settings, depth, "MM|target[+MM]"),
     .help = "far end, the tip, of poses that have none in a column far, mm from the device's position; or the "
             "target, and MM behind it",
     .excludes = "range", .role = OPTION_ASKS},
    {0},
};

/* The angles of "angles,arc=A0:A1:STEP,slider=M0:M1:STEP,back=MM": all arcs, of each all sliders. */
static bool read_angles(struct place *out, const struct source_keys *keys)
{
    static const double REACHED = 1e-9; /* degrees */
    enum { MOST = 1000000 };
    const enum source_key_id ids[] = {KEY_TILT_AP, KEY_TILT_ML};
    double counts[2];
    const double *grids[2];
    for (int i = 0; i < 2; i++) {
        grids[i] = keys_value(keys, ids[i])->numbers;
        counts[i] = floor((grids[i][1] - grids[i][0] + REACHED) / grids[i][2]) + 1;
        if (!(grids[i][2] > 0 && counts[i] >= 1)) {
            return refuse("--from angles: %s=FIRST:LAST:STEP is needed, with a STEP above 0, and FIRST not behind LAST",
                          i ? "slider" : "arc");
        }
    }
    out->back = keys_value(keys, KEY_DEPTH)->numbers[0];
    if (!(out->back > 0) || counts[0] * counts[1] > MOST) {
        return refuse(out->back > 0 ? "--from angles: more than 1000000 directions"
                                    : "--from angles: back=MM is needed");
    }
    out->angle_count = (size_t)(counts[0] * counts[1]);
    out->angles = calloc(2 * out->angle_count, sizeof *out->angles);
    const size_t sliders = (size_t)counts[1];
    for (size_t i = 0; out->angles && i < out->angle_count; i++) {
        const size_t at[2] = {i / sliders, i % sliders};
        out->angles[2 * i] = grids[0][0] + (double)at[0] * grids[0][2];
        out->angles[2 * i + 1] = grids[1][0] + (double)at[1] * grids[1][2];
    }
    return out->angles || print_no_memory() == EXIT_DONE;
}

static bool read_place(struct place *out, const char *option, const char *value, enum key_kind kind)
{
    struct source_keys keys;
    bool has_angles = kind == KEYS_ENTRIES && !option_names_file(&candidate_options[0], value);
    kind = has_angles ? KEYS_ANGLES : kind;
    out->path = strdup(value);
    if (!option_cut_keys(&keys, option, out->path, kind)) {
        return false;
    }
    if (has_angles) {
        return read_angles(out, &keys);
    }
    out->apart = keys_value(&keys, KEY_SPACING)->numbers[0];
    out->within = keys_string(&keys, KEY_WITHIN);
    out->without = keys_string(&keys, KEY_WITHOUT);
    out->of = keys_string(&keys, KEY_OF);
    out->flip = keys.given & KEY_BIT(KEY_FLIP);
    return true;
}

/* "70", "target", "target+3", "target-1" */
static bool read_depth(struct candidates *out, const char *text)
{
    static const char word[] = "target";
    out->to_target = strncmp(text, word, sizeof word - 1) == 0;
    const char *rest = out->to_target ? text + sizeof word - 1 : text;
    double *number = out->to_target ? &out->beyond : &out->far;
    bool has_sign = *rest == '+' || *rest == '-';
    bool is_fine = out->to_target && !*rest;
    if (!is_fine && has_sign == out->to_target) {
        is_fine =
            number_parse(rest + (*rest == '+'), number) && (out->to_target || *number > 0) && fabs(*number) <= 1e9;
    }
    return is_fine || refuse("--depth: \"%s\" is neither a number above 0 nor target[+MM]", text);
}

int candidates_parse(struct candidates *out, const struct candidate_settings *settings,
                     const struct arguments *arguments)
{
    *out = (struct candidates){.roll = settings->roll};
    bool is_file = option_given(arguments, "poses");
    if (!is_file && !settings->from) {
        return print_usage_error("no candidates given: --poses FILE, or --from FILE --toward WHAT");
    }
    if (settings->depth && !read_depth(out, settings->depth)) {
        return EXIT_USAGE;
    }
    if (is_file && out->to_target) {
        return print_usage_error("--depth target has no effect without --toward");
    }
    if (is_file) {
        const char *idle = settings->toward ? "toward" : settings->tilt ? "tilt" : settings->roll > 0 ? "roll" : NULL;
        return idle ? print_usage_error("--%s has no effect without --from", idle) : EXIT_DONE;
    }
    if (!settings->toward) {
        return print_usage_error("no targets given: --toward WHAT");
    }
    if (!settings->depth && !option_given(arguments, "range")) {
        return print_usage_error("no far end: --depth target, or target+MM, MM, or --range NEAR,FAR");
    }
    if (settings->tilt && numbers_parse(out->tilt, 2, settings->tilt, ',') != 2) {
        return print_usage_error("--tilt: \"%s\" is not two numbers MAX,STEP", settings->tilt);
    }
    return read_place(&out->from, "from", settings->from, KEYS_ENTRIES) &&
                   read_place(&out->toward, "toward", settings->toward, KEYS_TARGETS)
               ? EXIT_DONE
               : EXIT_USAGE;
}

void candidates_finish(struct candidates *candidates)
{
    free(candidates->from.path);
    free(candidates->toward.path);
    for (int i = 0; i < 2; i++) {
        struct place *place = i ? &candidates->toward : &candidates->from;
        conus_sites_destroy(place->sites);
        conus_pose_list_destroy(place->list);
        free(place->names);
        free(place->angles);
    }
    *candidates = (struct candidates){0};
}

/* The positions in a file of points or poses. */
static int take_points(struct place *place, const conus_pose_list *list)
{
    size_t count = conus_pose_list_count(list);
    double(*points)[3] = calloc(count + 1, sizeof *points);
    int code = points ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; points && i < count && !code; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        if (row->error) {
            code = print_usage_error("%s:%zu: %s", pose_settings_file_name(place->path), row->line, row->error);
        } else {
            memcpy(points[i], row->pose.world_from_device + 12, sizeof points[i]);
        }
    }
    conus_status status = code ? CONUS_OK : conus_sites_create(&place->sites, points ? points[0] : NULL, count);
    free(points);
    return status ? print_status(status) : code;
}

static conus_status load_mask(conus_roi **out, const char *path, const struct request *request)
{
    const conus_roi_options options = {.max_memory = request->settings->atlas.max_memory};
    return conus_roi_load(out, path, &options);
}

/* A volume without a threshold, which these options do not have. */
static int print_no_mask(conus_status status)
{
    return status != CONUS_ERROR_ARGUMENT
               ? print_status(status)
               : print_status_line(status, "%s; --from takes a mask, which has one value beside 0", conus_message());
}

/* Points of a file or, of entries, voxels of a mask. */
static int load_points(struct place *place, const struct request *request, bool may_be_mask)
{
    conus_pose_options options = request_pose_options(request);
    conus_pose_list *list = NULL;
    conus_roi *mask = NULL;
    char why[1024];
    options.scalp = may_be_mask ? request->places.scalp : NULL; /* entries */
    conus_status status = conus_pose_list_load(&list, place->path, &options);
    if (!status) {
        const struct request_settings *settings = request->settings;
        int code = pose_settings_match_list(list, place->path, &request->atlases, &settings->file, &settings->common);
        place->list = list;
        return code ? code : take_points(place, list);
    }
    snprintf(why, sizeof why, "%s", conus_message());
    conus_status of_mask = may_be_mask && !options.scalp ? load_mask(&mask, place->path, request) : status;
    if (!of_mask) {
        of_mask = conus_sites_of_roi(&place->sites, mask);
        conus_roi_destroy(mask);
        return of_mask ? print_status(of_mask) : EXIT_DONE;
    }
    return of_mask == CONUS_ERROR_ARGUMENT ? print_no_mask(of_mask) /* a volume, but no mask */
                                           : print_status_line(status, "%s", why);
}

/* Labels of vertices, a mask, or a structure of the atlas. */
static int keep(conus_sites *sites, const char *what, bool inside, const struct request *request)
{
    conus_roi *mask = NULL;
    conus_status status = CONUS_OK;
    const bool is_labels = conus_path_is_vertex_labels(what);
    if (is_labels) {
        status = conus_sites_keep_labelled(sites, what, inside);
    } else if (conus_atlas_is_path(what)) {
        status = load_mask(&mask, what, request);
        if (status) {
            return print_no_mask(status);
        }
        conus_sites_keep_roi(sites, mask, inside);
        conus_roi_destroy(mask);
    } else {
        status = conus_sites_keep_named(sites, request->answerers[0].selector, what, inside);
    }
    if (!status && !conus_sites_count(sites)) {
        return print_usage_error("--from: no candidate: %s=%s leaves no entry", inside ? "within" : "without", what);
    }
    return status && !is_labels && !conus_atlas_is_path(what)
               ? print_status_line(status, "--from: %s: %s", inside ? "within" : "without", conus_message())
               : print_status(status);
}

/* Vertices and voxels have been counted by their files, which are smaller. */
static int check_memory(const struct place *place, const char *option, const struct request *request)
{
    enum { SITE_BYTES = 64 };
    uint64_t most = request->settings->atlas.max_memory ? request->settings->atlas.max_memory : UINT64_C(8) << 30;
    size_t count = conus_sites_count(place->sites);
    return count <= most / SITE_BYTES
               ? EXIT_DONE
               : print_data_error("--%s: %s: %zu points take %d bytes each, allowed are %llu bytes (--max-memory)",
                                  option, place->path, count, SITE_BYTES, (unsigned long long)most);
}

/* What the file calls the points, where it gives each a name of its own that is no number. */
static int find_names(struct place *place)
{
    enum { LONGEST = 64 };
    const size_t count = conus_sites_count(place->sites);
    const char **names = place->list ? calloc(2 * count, sizeof *names) : NULL; /* and sorted */
    bool are_names = names;
    for (size_t i = 0; i < count && are_names; i++) {
        names[i] = conus_pose_list_row(place->list, (size_t)conus_sites_source(place->sites, i))->id;
        names[count + i] = names[i];
        are_names = !strchr("0123456789", names[i][0]) && strlen(names[i]) <= LONGEST;
    }
    if (are_names) {
        order_sort(names + count, count, sizeof *names, compare_text_pointers);
    }
    for (size_t i = 1; i < count && are_names; i++) {
        are_names = strcmp(names[count + i - 1], names[count + i]) != 0;
    }
    place->names = are_names ? names : NULL;
    if (!are_names) {
        free(names);
    }
    return place->list && !names ? print_no_memory() : EXIT_DONE;
}

/* Whether some name has the sign that stands between entry and target: where both have, "a-b-c" is of two needles. */
static bool has_dash(const struct place *place)
{
    bool has = false;
    for (size_t i = 0; place->names && i < conus_sites_count(place->sites) && !has; i++) {
        has = strchr(place->names[i], '-');
    }
    return has;
}

static int thin_out(struct place *place, const char *option, const struct request *request)
{
    if (!conus_sites_count(place->sites)) {
        return print_usage_error("--%s: no candidate: %s has no points", option, place->path);
    }
    conus_status status = place->apart > 0 ? conus_sites_space(place->sites, place->apart) : CONUS_OK;
    for (size_t i = 0; conus_sites_note(place->sites, i); i++) {
        say_note(conus_sites_note_severity(place->sites, i), request->settings->common.quiet, "%s",
                 conus_sites_note(place->sites, i));
    }
    int code = status ? print_status(status) : find_names(place);
    return code ? code : check_memory(place, option, request);
}

static int load_entries(struct place *place, const struct request *request)
{
    int code = EXIT_DONE;
    if (request->places.scalp && (place->angles || conus_context_is_surface(place->path))) {
        return print_usage_error(
            "--scalp has no effect: names of a cap's positions, in a list for --from, are found on it");
    }
    if (conus_context_is_surface(place->path)) {
        conus_status status = conus_sites_load(&place->sites, place->path, place->flip);
        code = print_status(status);
    } else if (place->flip) {
        code = print_usage_error("--from: flip is for surfaces, since only they have normals");
    } else {
        code = load_points(place, request, true);
    }
    code = code || !place->within ? code : keep(place->sites, place->within, true, request);
    code = code || !place->without ? code : keep(place->sites, place->without, false, request);
    return code ? code : thin_out(place, "from", request);
}

/* Targets of a file lie where the atlas is, at least some of them. */
static int check_targets(const struct place *place, const struct request *request)
{
    double low[3];
    double high[3];
    size_t count = conus_sites_count(place->sites);
    size_t outside = 0;
    conus_status status = conus_atlas_bounds(low, high, request->atlases.items[0].atlas);
    for (size_t i = 0; i < count && !status; i++) {
        const double *p = conus_sites_points(place->sites) + 3 * i;
        outside += !(p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] && p[0] <= high[0] && p[1] <= high[1] &&
                     p[2] <= high[2]);
    }
    if (status || (outside && outside == count)) {
        return status ? print_status(status)
                      : print_usage_error("--toward: %s: all targets lie outside of the atlas, which is from %.4g,%.4g,"
                                          "%.4g to %.4g,%.4g,%.4g",
                                          place->path, low[0], low[1], low[2], high[0], high[1], high[2]);
    }
    if (outside && !request->settings->common.quiet) {
        print_error_line("note: %s: %zu of %zu targets lie outside of the atlas", place->path, outside, count);
    }
    return EXIT_DONE;
}

static int load_targets(struct place *place, const struct request *request, const struct constraints *constraints)
{
    static const char *const kinds[] = {"centroid", "deepest", "voxels"}; /* in the order of conus_sites_kind */
    size_t kind = 0;
    const char *names = place->of;
    while (kind < 3 && strcmp(kinds[kind], place->path) != 0) {
        kind++;
    }
    if (kind == 3 && strspn(place->path, "+-.,0123456789 ") == strlen(place->path) && strchr(place->path, ',')) {
        return print_usage_error("--toward: \"%s\": points are rows of a file, behind a first line x,y,z", place->path);
    }
    if (kind == 3 && !conus_atlas_is_path(place->path) && strcmp(place->path, "-") != 0) {
        return print_usage_error(
            "--toward: \"%s\" is neither centroid, deepest, voxels nor normal, and there is no such file; "
            "deepest,of=%s is in the structure of that name",
            place->path, place->path);
    }
    if (kind == 3) {
        int code = place->of ? print_usage_error("--toward: of=%s is for centroid, deepest and voxels", place->of)
                             : load_points(place, request, false);
        code = code ? code : thin_out(place, "toward", request);
        return code ? code : check_targets(place, request);
    }
    for (size_t i = 0; i < constraints->count && !names; i++) {
        bool is_reach = constraints->items[i].kind == CONUS_CONSTRAINT_REACH;
        names = is_reach ? constraints->items[i].names : NULL;
    }
    if (!names) {
        return print_usage_error("--toward %s: of which structure? --reach NAME,... or of=NAME,...", place->path);
    }
    conus_status status =
        conus_sites_find(&place->sites, request->answerers[0].selector, names, (conus_sites_kind)kind);
    return status ? print_status_line(status, "--toward: %s", conus_message()) : thin_out(place, "toward", request);
}

int candidates_open(struct candidates *candidates, struct request *request, const struct constraints *constraints)
{
    bool is_normal = strcmp(candidates->toward.path, "normal") == 0;
    conus_candidates asked = {.tilt_most = candidates->tilt[0],
                              .tilt_step = candidates->tilt[1],
                              .roll_step = candidates->roll,
                              .to_target = candidates->to_target,
                              .beyond = candidates->beyond,
                              .frame = &request->frame};
    const bool has_angles = candidates->from.angles;
    bool is_there = candidates->from.sites || (has_angles && !request->places.scalp);
    int code = is_there ? EXIT_DONE : load_entries(&candidates->from, request);
    if (!code && !is_normal && !candidates->toward.sites) {
        code = load_targets(&candidates->toward, request, constraints);
    }
    if (code) {
        return code;
    }
    if (has_angles) {
        asked.angles = candidates->from.angles;
        asked.entry_count = candidates->from.angle_count;
        asked.back = candidates->from.back;
    } else {
        asked.entries = conus_sites_points(candidates->from.sites);
        asked.normals = conus_sites_normals(candidates->from.sites);
        asked.entry_count = conus_sites_count(candidates->from.sites);
    }
    if (is_normal && !asked.normals) {
        return print_usage_error("--toward normal: %s has no normals, which surfaces alone have",
                                 candidates->from.path);
    }
    asked.targets = is_normal ? NULL : conus_sites_points(candidates->toward.sites);
    asked.target_count = conus_sites_count(candidates->toward.sites);
    const bool are_clear = !has_dash(&candidates->from) || !has_dash(&candidates->toward);
    asked.entry_names = are_clear ? candidates->from.names : NULL;
    asked.target_names = are_clear ? candidates->toward.names : NULL;
    return print_status(conus_candidates_open(&request->stream, &asked));
}

void candidates_list_inputs(struct provenance *out, const struct candidates *candidates)
{
    const char *const files[] = {candidates->from.path, candidates->from.within, candidates->from.without,
                                 candidates->toward.path};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        provenance_add_input(out, files[i] && conus_atlas_is_path(files[i]) ? files[i] : NULL);
    }
}

/* Between quotation marks, those in it with `mark` in front. */
static void put_id(FILE *out, const char *id, char mark)
{
    fputc('"', out);
    for (; *id; id++) {
        if (*id == '"' || (*id == '\\' && mark == '\\')) {
            fputc(mark, out);
        }
        fputc((unsigned char)*id < ' ' ? ' ' : *id, out);
    }
    fputc('"', out);
}

/* Whether all poses are turned as one that has only an axis (Eq. 2). */
static bool have_usual_turns(const struct written_pose *poses, size_t count, const conus_frame *frame)
{
    bool all = true;
    for (size_t i = 0; i < count && all; i++) {
        const double *m = poses[i].pose->pose.world_from_device;
        conus_pose usual;
        all = !conus_pose_along(&usual, m + 12, (const double[]){-m[8], -m[9], -m[10]}, NULL);
        if (all) {
            conus_frame_turn_pose(&usual, frame, false);
        }
        for (int k = 0; k < 16; k++) {
            all = all && usual.world_from_device[k] == m[k];
        }
    }
    return all;
}

/* 17 digits are those of one double. */
static void put_table(FILE *out, const struct written_pose *poses, size_t count, const conus_frame *frame)
{
    const bool of_needles = count && poses[0].needle;
    bool has_up = of_needles || !have_usual_turns(poses, count, frame);
    const bool has_contacts = of_needles && poses[0].counts_contacts;
    bool has_angle = false;
    for (size_t i = 0; i < count; i++) {
        has_angle = has_angle || poses[i].pose->has_angle;
    }
    fprintf(out, "%squery_id\tx\ty\tz\tdx\tdy\tdz%s\tnear\tfar%s%s%s\n", of_needles ? "needle\trow\tcandidate\t" : "",
            has_up ? "\tux\tuy\tuz" : "", has_angle ? "\tangle" : "", of_needles ? "\tleeway_mm" : "",
            has_contacts ? "\tcontacts" : "");
    for (size_t i = 0; i < count; i++) {
        const conus_planned *pose = poses[i].pose;
        const double *m = pose->pose.world_from_device;
        const double axis[3] = {-m[8], -m[9], -m[10]};
        double v[3][3];
        conus_frame_from_world(v[0], frame, m + 12);
        conus_frame_direction_from_world(v[1], frame, axis);
        conus_frame_direction_from_world(v[2], frame, m + 4);
        if (of_needles) {
            put_id(out, poses[i].needle, '"');
            fprintf(out, "\t%zu\t%llu\t", poses[i].row, (unsigned long long)poses[i].number);
        }
        put_id(out, poses[i].id, '"');
        for (int k = 0; k < (has_up ? 9 : 6); k++) {
            fprintf(out, "\t%.17g", v[k / 3][k % 3]);
        }
        fprintf(out, "\t%.17g\t%.17g", pose->near, pose->far);
        if (has_angle && pose->has_angle) {
            fprintf(out, "\t%.17g", pose->angle);
        } else if (has_angle) {
            fputs("\tn/a", out);
        }
        if (of_needles) {
            fprintf(out, isnan(pose->leeway) ? "\tn/a" : "\t%.9g", pose->leeway);
        }
        if (has_contacts) {
            fprintf(out, "\t%llu", (unsigned long long)poses[i].contacts);
        }
        fputc('\n', out);
    }
}

static size_t shanks_of(const struct written_pose *pose)
{
    return pose->shanks ? pose->shank_count : 1;
}

/* A point of a shank, RAS. */
static void find_point(double out[3], const struct written_pose *pose, size_t shank, double depth)
{
    const double *m = pose->pose->pose.world_from_device;
    const double *beside = pose->shanks ? pose->shanks + 2 * shank : (const double[]){0, 0};
    for (int a = 0; a < 3; a++) {
        out[a] = m[12 + a] + beside[0] * m[a] + beside[1] * m[4 + a] - depth * m[8 + a];
    }
}

/* One end of a shank: a control point in LPS. */
static void put_end(FILE *out, const struct written_pose *pose, const char *id, size_t shank, double depth)
{
    double at[3];
    find_point(at, pose, shank, depth);
    fputs("{\"label\": ", out);
    put_id(out, id, '\\');
    fprintf(out, ", \"position\": [%.17g, %.17g, %.17g]}", -at[0], -at[1], at[2]);
}

/* A line for each shank; of several, "e1-t2-s3" is the third. */
static void put_lines(FILE *out, const struct written_pose *poses, size_t count)
{
    const char *before = "";
    fputs("{\"@schema\": \"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
          "Schema/markups-schema-v1.0.3.json#\",\n \"markups\": [",
          out);
    for (size_t i = 0; i < count; i++) {
        for (size_t shank = 0; shank < shanks_of(&poses[i]); shank++) {
            char id[320];
            snprintf(id, sizeof id, "%s", poses[i].id);
            if (shanks_of(&poses[i]) > 1) {
                snprintf(id, sizeof id, "%s-s%zu", poses[i].id, shank + 1);
            }
            fprintf(out, "%s\n  {\"type\": \"Line\", \"coordinateSystem\": \"LPS\", \"controlPoints\": [", before);
            put_end(out, &poses[i], id, shank, 0);
            fputs(", ", out);
            put_end(out, &poses[i], id, shank, poses[i].pose->far);
            fputs("]}", out);
            before = ",";
        }
    }
    fputs("\n ]}\n", out);
}

/* The same as polylines, which have the leeway of their pose. */
static void put_polylines(FILE *out, const struct written_pose *poses, size_t count)
{
    size_t lines = 0;
    for (size_t i = 0; i < count; i++) {
        lines += shanks_of(&poses[i]);
    }
    fprintf(out, "# vtk DataFile Version 3.0\nconus plan; SPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS %zu double\n",
            2 * lines);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 2 * shanks_of(&poses[i]); k++) {
            double at[3];
            find_point(at, &poses[i], k / 2, k % 2 ? poses[i].pose->far : 0);
            fprintf(out, "%.17g %.17g %.17g\n", at[0], at[1], at[2]);
        }
    }
    fprintf(out, "LINES %zu %zu\n", lines, 3 * lines);
    for (size_t i = 0; i < lines; i++) {
        fprintf(out, "2 %zu %zu\n", 2 * i, 2 * i + 1);
    }
    fprintf(out, "CELL_DATA %zu\nSCALARS leeway_mm double 1\nLOOKUP_TABLE default\n", lines);
    for (size_t i = 0; i < count; i++) {
        for (size_t shank = 0; shank < shanks_of(&poses[i]); shank++) {
            fprintf(out, "%.9g\n", poses[i].pose->leeway);
        }
    }
}

static void put_matrix(FILE *out, const struct written_pose *pose)
{
    const double *m = pose->pose->pose.world_from_device;
    for (int row = 0; row < 4; row++) {
        fprintf(out, "%.17g %.17g %.17g %.17g\n", m[row], m[4 + row], m[8 + row], m[12 + row]);
    }
}

int candidates_write(const char *path, const struct written_pose *poses, size_t count, const conus_frame *frame)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return print_no_memory();
    }
    if (path_ends_in(path, ".tsv")) {
        put_table(out, poses, count, frame);
    } else if (path_ends_in(path, ".json")) {
        put_lines(out, poses, count);
    } else if (path_ends_in(path, ".vtk")) {
        put_polylines(out, poses, count);
    } else if (count) {
        put_matrix(out, &poses[0]);
    }
    int code = system_text_close(&text) ? output_write(path, text.data, text.size) : print_no_memory();
    free(text.data);
    return code;
}
