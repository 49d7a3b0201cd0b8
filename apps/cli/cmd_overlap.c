/* SPDX-License-Identifier: BSD-3-Clause */
/* conus overlap: which areas and pathways regions of interest cover. */
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct overlap_settings {
    struct request_settings request; /* first */
    double threshold;
    const char *clusters;
    bool any_space;
};

static const struct option region_options[] = {
    {OPTION_VALUED("threshold", struct overlap_settings, threshold, "T"),
     .help = "voxels, or tetrahedra, with values of at least T belong to the region; of a negative T, those with "
             "values of at most T",
     .hint = "; for a one-sided p of 0.05, 0.01 or 0.001 type 1.64, 2.33 or 3.09 if it is a map of z; of t the value "
             "depends on the degrees of freedom; of a map of per cent 50 is 50 %",
     .otherwise = "of masks only, all that are not 0", .words = "binarise, cut-off", .common = true},
    {OPTION_NAMED("any-space", struct overlap_settings, any_space),
     .help = "take regions as lying in the atlas's space, whatever brain their headers name"},
    {0},
};

static const struct option cluster_options[] = {
    {OPTION_VALUED("clusters", struct overlap_settings, clusters, "FILE"),
     .help =
         "write a table of the region's clusters, the largest first: each with its size, peak, centre of mass and the "
         "areas that it covers, and with its local maxima",
     .words = "cluster table, peaks, local maxima", .common = true, .role = OPTION_WRITES_ROWS, .holds = HOLDS_ROWS},
    {0},
};

static const struct option_group groups[] = {
    {"What the region is", region_options, 0},
    {"", space_options, REQUEST_FIELD(aim.space)},
    {"What it may cover", atlas_options, REQUEST_FIELD(atlas)},
    {"", side_options, REQUEST_FIELD(atlas)},
    REQUEST_NO_POSE_ATLAS_GROUPS,
    REQUEST_OUTPUT_GROUPS,
    {"", cluster_options, 0},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/* An overlap under way. */
struct overlap {
    const struct overlap_settings *settings;
    struct request request;
};

static const char *region_path(const struct overlap *overlap, size_t index)
{
    return index ? overlap->request.arguments->more.items[index - 1] : overlap->request.arguments->operands[1];
}

static conus_status load_region(conus_roi **out, const struct overlap *overlap, const char *path, conus_log log)
{
    const struct overlap_settings *settings = overlap->settings;
    const conus_roi_options options = {
        .threshold = settings->threshold, .max_memory = settings->request.atlas.max_memory, .log = log};
    return conus_roi_load(out, path, &options);
}

/* Whether a map or a mask was given as ATLAS: the first operand loads as a region, or would with a threshold, and as no
 * atlas or as one of a single area. */
static bool atlas_is_region(const struct overlap *overlap)
{
    const conus_atlas *atlas = overlap->request.atlases.count ? overlap->request.atlases.items[0].atlas : NULL;
    conus_roi *roi = NULL;
    conus_status status = load_region(&roi, overlap, overlap->request.arguments->operands[0], NULL);
    conus_roi_destroy(roi);
    return (status == CONUS_OK || status == CONUS_ERROR_ARGUMENT) && (!atlas || conus_atlas_object_count(atlas) == 1);
}

/* Whether an atlas of several areas was given as ROI. */
static bool region_is_atlas(const struct overlap *overlap, const char *path)
{
    const struct atlas_settings *given = &overlap->settings->request.atlas;
    const struct atlas_settings settings = {.max_memory = given->max_memory, .answers = true};
    conus_atlas *atlas = NULL;
    bool is_atlas = !atlas_input_load(&atlas, path, &settings) && conus_atlas_object_count(atlas) > 1;
    conus_atlas_destroy(atlas);
    return is_atlas;
}

/* Runs while messages are held: prints the last one, with the option that is missing, and says so where ATLAS and ROI
 * seem to have changed places or both are atlases. */
static int print_failure(const struct overlap *overlap, const char *path, int code)
{
    char why[1024];
    snprintf(why, sizeof why, "%s", error_line());
    struct atlas_name named = {0};
    bool is_name = !atlas_name_find(&named, path) && named.atlas;
    bool changed = atlas_is_region(overlap);
    bool has_atlas = overlap->request.atlases.count && overlap->request.atlases.items[0].atlas;
    bool is_atlas = (changed || has_atlas) && (is_name || region_is_atlas(overlap, path));
    messages_hold(false);
    const char *option = strstr(why, "a threshold is needed") ? ": --threshold T" : "";
    if (is_atlas && changed) {
        print_error_line("%s; %s is an atlas: ATLAS comes first, then ROI", why, path);
    } else if (is_atlas && *option) { /* it may be a map of whole numbers as well */
        print_error_line("%s%s; if these are labels, save the one that is meant as a mask (the largest as T is taken "
                         "alone); if it is an atlas, --atlas %s lists its parts, too",
                         why, option, path);
    } else if (is_atlas) {
        print_error_line("%s; %s is an atlas, and no region: ROI is a mask or a map, whose parts in that atlas are "
                         "listed, too, by --atlas %s",
                         why, path, path);
    } else {
        print_error_line("%s%s", why, option);
    }
    atlas_name_finish(&named);
    return code;
}

/* Refuses a region of another brain than the atlas's, as poses are, or of a scan where that is a template's. */
static int check_brain(const struct overlap *overlap, const struct named_atlas *named, const conus_volume_info *info)
{
    char prefix[ATLAS_PREFIX_SIZE];
    const conus_volume_info *atlas = conus_atlas_volume(named->atlas, 0);
    const conus_brain_view brains[] = {conus_volume_brain(info), conus_atlas_brain(named->atlas)};
    const conus_brain_gap gap = conus_brain_compare(brains[0], brains[1]);
    bool is_template = brains[1].brain && brains[1].brain != CONUS_BRAIN_OWN;
    bool is_other = !gap && (!brains[0].brain || !brains[1].brain) && spaces_differ(info, atlas);
    bool quiet = overlap->settings->request.common.quiet;
    atlases_prefix(prefix, named);
    if (!overlap->settings->any_space && (gap == CONUS_BRAIN_GAP_OTHER || (is_other && is_template))) {
        return print_data_error(
            "%s%s: is of another brain (%s) than the atlas (%s): bring it to the atlas's, or move the atlas there "
            "(--atlas-transform); only if it lies in the atlas's space (ITK-SNAP and ANTs write scanner for MNI, too), "
            "type --any-space",
            prefix, info->path, is_other ? info->transform : brains[0].words, brains[1].words);
    }
    if (gap) {
        say_note(gap == CONUS_BRAIN_GAP_SMALL ? CONUS_SEVERITY_NOTE : CONUS_SEVERITY_WARNING, quiet,
                 "%s%s: is of another brain (%s) than the atlas (%s)", prefix, info->path, brains[0].words,
                 brains[1].words);
    } else if (is_other) {
        say_note(CONUS_SEVERITY_NOTE, quiet, "%s%s: its header names another space (%s) than the atlas's (%s)", prefix,
                 info->path, info->transform, atlas->transform);
    }
    return EXIT_DONE;
}

/* A note where an atlas has bundles, which have no row. */
static void say_bundles(const struct overlap *overlap, const struct named_atlas *named)
{
    char prefix[ATLAS_PREFIX_SIZE];
    const char *first = NULL;
    size_t count = 0;
    for (size_t number = conus_atlas_object_count(named->atlas); number; number--) {
        const conus_object *object = conus_atlas_object(named->atlas, number);
        if (object->kind == CONUS_KIND_BUNDLE && !conus_atlas_is_hidden(named->atlas, (uint32_t)number)) {
            first = object->name;
            count++;
        }
    }
    atlases_prefix(prefix, named);
    if (count) {
        say_note(CONUS_SEVERITY_NOTE, overlap->settings->request.common.quiet,
                 "%s%s%s: a bundle has no inside, and no row; a map of where its streamlines are has one, as --pathway",
                 prefix, first, count > 1 ? " and other bundles" : "");
    }
}

/* Adds the areas of one atlas that the region covers. */
static int add_answer(struct overlap *overlap, size_t index, const char *path, const conus_roi *roi)
{
    struct answerer *answerer = &overlap->request.answerers[index];
    const struct named_atlas *named = &overlap->request.atlases.items[index];
    conus_table *coverages = NULL;
    char prefix[ATLAS_PREFIX_SIZE];
    int code = check_brain(overlap, named, conus_roi_volume(roi));
    if (code) {
        return code;
    }
    conus_status status = conus_overlap(&coverages, answerer->selector, roi);
    status = status ? status : conus_report_add_table(answerer->report, path, coverages);
    bool is_beside = !status && (!conus_table_rows(coverages) || !conus_table_objects(coverages)[0]);
    say_note(CONUS_SEVERITY_NOTE, !is_beside || overlap->settings->request.common.quiet,
             "%s%s: covers no area and no pathway; are it and the atlas in one space?", atlases_prefix(prefix, named),
             conus_roi_volume(roi)->path);
    conus_table_destroy(coverages);
    struct asked asked = {.roi = roi};
    status = status ? status : rows_files_add(&overlap->request.rows, index, answerer->selector, path, &asked);
    return print_status(status);
}

static int add_region(struct overlap *overlap, const char *path)
{
    conus_roi *roi = NULL;
    conus_status status =
        load_region(&roi, overlap, path, overlap->settings->request.common.quiet ? log_note_quiet : log_note);
    if (status) {
        messages_hold(true);
        return print_failure(overlap, path, print_status(status));
    }
    int code = outputs_spare_inputs(&overlap->request.outputs) ? EXIT_DONE : EXIT_USAGE;
    for (size_t i = 0; !code && i < overlap->request.atlases.count; i++) {
        code = add_answer(overlap, i, path, roi);
    }
    conus_roi_destroy(roi);
    return code;
}

static int answer_overlap(struct overlap *overlap)
{
    struct request *request = &overlap->request;
    messages_hold(true);
    int code = request_load_atlases(request);
    if (code) {
        return print_failure(overlap, region_path(overlap, 0), code);
    }
    messages_hold(false);
    code = space_settings_frame(&request->frame, &request->atlases, &request->settings->aim.space,
                                request->settings->common.quiet);
    conus_report_options report = request_report_options(request);
    report.rows = "coverages";
    report.no_voxels = true;
    code = code ? code : request_start_without_rays(request, &report);
    code = code ? code : request_check_outputs(request);
    for (size_t i = 0; !code && i <= request->arguments->more.count; i++) {
        code = add_region(overlap, region_path(overlap, i));
    }
    if (code) {
        return code;
    }
    request_say_notes(request);
    for (size_t i = 0; i < request->atlases.count; i++) {
        say_bundles(overlap, &request->atlases.items[i]);
    }
    struct provenance provenance = {0};
    request_list_inputs(&provenance, request);
    provenance.question.rows = "coverages";
    provenance.question.region = "volume";
    code = rows_files_write(&request->rows, &provenance);
    return code ? code : request_write_answer(request, &provenance);
}

static int run_overlap(const void *given, const struct arguments *arguments)
{
    const struct overlap_settings *settings = given;
    struct overlap overlap = {.settings = settings};
    if (option_given(arguments, "threshold") && settings->threshold == 0) {
        return print_usage_error("--threshold: 0 would take the whole volume; leave it out for a mask, else give "
                                 "the least value that counts, as 0.001");
    }
    if (!space_settings_check(arguments, &settings->request.aim.space)) {
        return EXIT_USAGE;
    }
    int code = request_init(&overlap.request, &settings->request, arguments);
    code = code ? code : answer_overlap(&overlap);
    request_finish(&overlap.request);
    return code;
}

const struct command cmd_overlap = {
    .name = "overlap",
    .summary = "list the areas and pathways that a region of interest covers, with volumes and peaks",
    .operands = {"ATLAS", "ROI"},
    .words = "lesion, mask, ROI, region, VTA",
    .holds = {HOLDS_ATLAS, HOLDS_VOLUME},
    .repeats = true,
    .description =
        "ROI is a volume on a grid of its own, in the space of ATLAS: a mask (a lesion, a stimulated volume) or a\n"
        "statistical map with --threshold; or a field of SimNIBS (.hdf5) with --threshold: the tetrahedra whose |E|\n"
        "reaches it. ROI,field=NAME takes another field, ROI,tissue=1:2 white and grey matter only. Reports for every\n"
        "area and pathway the volume that both have in common, as a part of the area and of the region, and the\n"
        "region's peak there. Of several ROIs one after the other.",
    .examples = "  conus overlap aal lesion.nii.gz\n"
                "  conus overlap aparc+aseg.mgz simulation.hdf5,tissue=2 --threshold 0.5\n"
                "  conus overlap aal zstat1.nii.gz --threshold 3.1 -o overlap.tsv\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct overlap_settings),
    .run = run_overlap,
};
