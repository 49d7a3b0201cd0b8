/* SPDX-License-Identifier: BSD-3-Clause */
/* conus overlap: which areas and pathways regions of interest cover. */
#include "cli/answers/answer_format.h"
#include "cli/commands.h"
#include "common/messages.h"
#include "common/output.h"
#include "settings/atlas_notes.h"

#include <stdlib.h>

struct overlap_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct answer_settings answer;
    double threshold;
    struct engine_settings engine; /* level only */
    struct space_settings space;
};

#define FIELD(member) offsetof(struct overlap_settings, member)

static const struct option region_options[] = {
    {.name = "threshold",
     .type = OPTION_NUMBER,
     .offset = FIELD(threshold),
     .value = "T",
     .help = "voxels with values of at least T belong to the region; of a negative T, those with values of at most T "
             "(default, of masks only: all voxels that are not 0)"},
    {0},
};

static const struct option level_options[] = {
    {.name = "level",
     .type = OPTION_TEXT,
     .offset = FIELD(engine.level),
     .value = "LEVEL",
     .help = "report areas at this depth of the area tree (1 = its roots), or as these areas: names, @FILE"},
    {0},
};

static const struct option_group groups[] = {
    {"What the region is", region_options, 0},
    {"", space_options, FIELD(space)},
    {"What it may cover", atlas_options, FIELD(atlas)},
    {"", shown_options, FIELD(atlas)},
    {"", level_options, 0},
    {"", more_atlas_options, FIELD(atlas)},
    {"What is written", format_options, FIELD(answer)},
    {"", answer_output_options, FIELD(answer)},
    {"", quiet_options, FIELD(common)},
    {0},
};

/* What answers for one atlas. */
struct answerer {
    conus_selector *selector;
    conus_report *report; /* the first one's has the others' joined */
};

/* An overlap under way. */
struct overlap {
    const struct overlap_settings *settings;
    const struct arguments *arguments;
    conus_format format;
    char *command_line;
    char *sidecar; /* path; NULL = none */
    struct atlases atlases;
    conus_frame frame;          /* of positions */
    struct answerer *answerers; /* [atlases.count] */
};

static void overlap_finish(struct overlap *overlap)
{
    for (size_t i = 0; overlap->answerers && i < overlap->atlases.count; i++) {
        conus_report_destroy(overlap->answerers[i].report);
        conus_selector_destroy(overlap->answerers[i].selector);
    }
    free(overlap->answerers);
    atlases_finish(&overlap->atlases);
    free(overlap->command_line);
    free(overlap->sidecar);
}

/* ---- Regions ---------------------------------------------------------------------------------------------------- */

static size_t region_count(const struct overlap *overlap)
{
    return overlap->arguments->more.count + 1;
}

static const char *region_path(const struct overlap *overlap, size_t index)
{
    return index ? overlap->arguments->more.items[index - 1] : overlap->arguments->operands[1];
}

/* What a careful user should know about where a region lies. */
static void say_place(const struct overlap *overlap, size_t index, const conus_roi *roi, const conus_overlap *coverages)
{
    char prefix[ATLAS_PREFIX_SIZE];
    const struct named_atlas *named = &overlap->atlases.items[index];
    const conus_volume_info *info = conus_roi_volume(roi);
    const conus_coverage *best = conus_overlap_coverage(coverages, 0);
    const conus_volume_info *atlas = conus_atlas_volume(named->atlas, 0);
    if (overlap->settings->common.quiet) {
        return;
    }
    atlases_prefix(prefix, named);
    if (!best->object) {
        print_error_line("note: %s%s: covers no area and no pathway; are it and the atlas in one space?", prefix,
                         info->path);
    }
    if (spaces_differ(info, atlas)) {
        print_error_line("note: %s%s: its header names another space (%s) than the atlas's (%s)", prefix, info->path,
                         info->transform, atlas->transform);
    }
}

/* Whether no output is the region's file. */
static bool check_region(const struct overlap *overlap, const conus_roi *roi)
{
    const char *output = overlap->settings->answer.output;
    const char *const outputs[] = {output_is_stdout(output) ? NULL : output, overlap->sidecar};
    for (size_t i = 0; i < 2; i++) {
        if (outputs[i] && paths_equal(outputs[i], conus_roi_volume(roi)->path)) {
            print_error_line("--output would overwrite the region %s", outputs[i]);
            return false;
        }
    }
    return true;
}

/* What the region covers of one atlas. */
static int add_answer(struct overlap *overlap, size_t index, const char *path, const conus_roi *roi)
{
    struct answerer *answerer = &overlap->answerers[index];
    conus_overlap *coverages = NULL;
    conus_status status = conus_overlap_create(&coverages, answerer->selector, roi);
    status = status ? status : conus_report_add_overlap(answerer->report, path, coverages);
    if (!status) {
        say_place(overlap, index, roi, coverages);
    }
    conus_overlap_destroy(coverages);
    return status ? print_status(status) : EXIT_DONE;
}

static int add_region(struct overlap *overlap, const char *path)
{
    const struct overlap_settings *settings = overlap->settings;
    const conus_roi_options options = {.threshold = settings->threshold,
                                       .max_memory = settings->atlas.max_memory,
                                       .log = settings->common.quiet ? NULL : log_note};
    conus_roi *roi = NULL;
    conus_status status = conus_roi_load(&roi, path, &options);
    int code = status ? print_status(status) : check_region(overlap, roi) ? EXIT_DONE : EXIT_USAGE;
    for (size_t i = 0; !code && i < overlap->atlases.count; i++) {
        code = add_answer(overlap, i, path, roi);
    }
    conus_roi_destroy(roi);
    return code;
}

/* ---- Steps ------------------------------------------------------------------------------------------------------ */

/* --level is of the first atlas. */
static conus_status start_answerer(struct overlap *overlap, size_t index)
{
    const struct overlap_settings *settings = overlap->settings;
    const struct named_atlas *named = &overlap->atlases.items[index];
    struct answerer *answerer = &overlap->answerers[index];
    const conus_selector_options selector = {.level = index ? NULL : settings->engine.level,
                                             .engine = CONUS_ENGINE_RAYS};
    const conus_report_options report = {.rows = CONUS_ROWS_COVERAGES,
                                         .format = overlap->format,
                                         .frame = &overlap->frame,
                                         .command = overlap->command_line,
                                         .no_voxels = true,
                                         .atlas = named->name};
    conus_status status = conus_selector_create(&answerer->selector, named->atlas, &selector);
    status = status ? status : conus_report_create(&answerer->report, answerer->selector, &report);
    return status || !index ? status : conus_report_join(overlap->answerers[0].report, answerer->report);
}

static int load_atlases(struct overlap *overlap)
{
    struct atlases *atlases = &overlap->atlases;
    int code = atlases_load(atlases, overlap->arguments->operands[0], &overlap->settings->atlas);
    conus_status status = CONUS_OK;
    code = code ? code
                : settings_frame(&overlap->frame, atlases, &overlap->settings->space, overlap->settings->common.quiet);
    if (code) {
        return code;
    }
    overlap->answerers = calloc(atlases->count, sizeof *overlap->answerers);
    if (!overlap->answerers) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    for (size_t i = 0; i < atlases->count && !status; i++) {
        status = start_answerer(overlap, i);
    }
    return status ? print_status(status) : EXIT_DONE;
}

/* Whether no output is a file that is read. */
static bool check_output(const struct overlap *overlap, const char *path)
{
    const struct input inputs[] = {{"the label table", overlap->settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&overlap->settings->engine)},
                                   {0}};
    const char *input = path ? atlases_input(&overlap->atlases, inputs, path) : NULL;
    if (input) {
        print_error_line("--output would overwrite %s %s", input, path);
    }
    return !input;
}

static int answer(struct overlap *overlap)
{
    const char *output = overlap->settings->answer.output;
    int code = load_atlases(overlap);
    if (!code && (!check_output(overlap, output_is_stdout(output) ? NULL : output) ||
                  !check_output(overlap, overlap->sidecar))) {
        return EXIT_USAGE;
    }
    for (size_t i = 0; !code && i < region_count(overlap); i++) {
        code = add_region(overlap, region_path(overlap, i));
    }
    if (code) {
        return code;
    }
    atlases_say_notes(&overlap->atlases, &overlap->settings->common);
    atlases_say_spaces(&overlap->atlases, &overlap->settings->common);
    struct provenance provenance = {0};
    provenance_add_input(&provenance, settings_level_file(&overlap->settings->engine));
    return answer_write(overlap->answerers[0].report, output, overlap->sidecar, &provenance);
}

static int run_overlap(const void *given, const struct arguments *arguments)
{
    const struct overlap_settings *settings = given;
    struct overlap overlap = {.settings = settings, .arguments = arguments};
    if (option_given(arguments, "threshold") && settings->threshold == 0) {
        return print_usage_error("--threshold: 0 would take the whole volume; leave it out for a mask");
    }
    if (!settings_check_space(arguments, &settings->space) ||
        !answer_format(&overlap.format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    overlap.command_line = arguments_text(arguments);
    int code = overlap.command_line ? answer_sidecar(&overlap.sidecar, overlap.format, &settings->answer) : EXIT_DATA;
    if (!overlap.command_line) {
        print_error_line("not enough memory");
    }
    code = code ? code : answer(&overlap);
    overlap_finish(&overlap);
    return code;
}

const struct command cmd_overlap = {
    .name = "overlap",
    .summary = "list the areas and pathways that a region of interest covers, with volumes and peaks",
    .operands = {"ATLAS", "ROI"},
    .repeats = true,
    .description =
        "ROI is a volume on a grid of its own, in the space of ATLAS: a mask (a lesion, a stimulated volume) or a\n"
        "statistical map with --threshold. Reports for every area and pathway the volume that both have in common,\n"
        "as a part of the area and of the region, and the region's peak there. Of several ROIs one after the other.",
    .examples = "  conus overlap aal lesion.nii.gz\n"
                "  conus overlap aal zstat1.nii.gz --threshold 3.1 -o overlap.tsv\n",
    .groups = groups,
    .settings_size = sizeof(struct overlap_settings),
    .run = run_overlap,
};
