/* SPDX-License-Identifier: BSD-3-Clause */
/* conus connect: which areas the streamlines of bundles connect, all of them, without a pose. */
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "options/messages.h"

#include <inttypes.h>
#include <stdlib.h>

struct connect_settings {
    struct request_settings request; /* first */
    struct ends_settings ends;
};

static const struct option_group groups[] = {
    {"What is connected", atlas_options, REQUEST_FIELD(atlas)},
    {"", side_options, REQUEST_FIELD(atlas)},
    REQUEST_NO_POSE_ATLAS_GROUPS,
    REQUEST_OUTPUT_GROUPS,
    {"", connectivity_options, offsetof(struct connect_settings, ends)},
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/* An answer under way. */
struct connect {
    const struct connect_settings *settings;
    struct request request;
};

static size_t count_hidden_areas(const conus_atlas *atlas)
{
    const conus_object *object;
    size_t hidden = 0;
    for (uint32_t number = 1; (object = conus_atlas_object(atlas, number)); number++) {
        hidden += object->kind == CONUS_KIND_AREA && conus_atlas_is_hidden(atlas, number);
    }
    return hidden;
}

/* A warning where most streamlines have no area at either end, as those of another space or unit. */
static void say_without_areas(const struct connect *connect, const struct named_atlas *named, const conus_table *table)
{
    char prefix[ATLAS_PREFIX_SIZE];
    uint64_t all = 0;
    uint64_t without = 0;
    const conus_table *pairs = conus_table_part(table, "pairs");
    const int64_t *streamlines = conus_table_counts(pairs, "streamlines");
    const int64_t *area_a = conus_table_counts(pairs, "area_a"); /* where one end has an area, it is this */
    const uint32_t *areas = conus_table_objects(conus_table_part(table, "areas"));
    for (size_t i = 0; i < conus_table_rows(pairs); i++) {
        all += (uint64_t)streamlines[i];
        without += areas[area_a[i]] ? 0 : (uint64_t)streamlines[i];
    }
    if (2 * without > all && !count_hidden_areas(named->atlas)) {
        say_note(CONUS_SEVERITY_WARNING, connect->settings->request.common.quiet,
                 "%s%" PRIu64 " of %" PRIu64 " streamlines have no area at either end: are they in the atlas's space "
                 "and unit?",
                 atlases_prefix(prefix, named), without, all);
    }
}

static int add_answer(struct connect *connect, size_t index)
{
    const double radius = ends_radius_of(&connect->settings->ends, connect->request.arguments);
    struct answerer *answerer = &connect->request.answerers[index];
    conus_table *table = NULL;
    conus_status status = conus_connectivity(&table, answerer->selector, NULL, radius, true);
    status = status ? status : conus_report_add_table(answerer->report, "1", table);
    int code = print_status(status);
    if (!code) {
        say_without_areas(connect, &connect->request.atlases.items[index], table);
        struct asked asked = {.made = table, .made_of = "connections"};
        return print_status(rows_files_add(&connect->request.rows, index, answerer->selector, "1", &asked));
    }
    conus_table_destroy(table);
    return code;
}

/* An end near the border of a hidden area may have another area than in the whole atlas. */
static void say_hidden_areas(const struct connect *connect)
{
    const conus_atlas *atlas = connect->request.atlases.items[0].atlas;
    const struct ends_settings *ends = &connect->settings->ends;
    const struct arguments *arguments = connect->request.arguments;
    const size_t hidden = count_hidden_areas(atlas);
    bool looks_round = !option_given(arguments, "endpoint-radius") || ends->radius > 0;
    if (hidden && looks_round && !connect->settings->request.common.quiet) {
        say_note(CONUS_SEVERITY_NOTE, false,
                 "%zu area%s hidden: an end in one of them has the nearest area that is not, if it is near "
                 "enough; with --endpoint-radius 0 none",
                 hidden, hidden == 1 ? " is" : "s are");
    }
}

static int answer_connect(struct connect *connect)
{
    struct request *request = &connect->request;
    struct provenance provenance = {0};
    conus_report_options report = request_report_options(request);
    report.rows = "connections";
    int code = print_status(conus_frame_find(&request->frame, NULL, CONUS_SPACE_RAS, NULL)); /* of no positions */
    code = code ? code : request_load_atlases(request);
    code = code ? code : request_start_without_rays(request, &report);
    code = code ? code : request_check_outputs(request);
    code = code || ends_check_atlases(&request->atlases) ? code : EXIT_USAGE;
    for (size_t i = 0; !code && i < request->atlases.count; i++) {
        code = add_answer(connect, i);
    }
    if (code) {
        return code;
    }
    say_hidden_areas(connect);
    request_say_notes(request);
    request_list_inputs(&provenance, request);
    provenance.question.rows = "connections";
    provenance.question.region = "all";
    code = rows_files_write(&request->rows, &provenance);
    return code ? code : request_write_answer(request, &provenance);
}

/* The tractograms behind ATLAS, and those of --streamlines. NULL without memory. */
static const char **list_tractograms(struct option_list *out, const struct arguments *arguments)
{
    const struct option_list given = *out;
    const struct option_list *more = &arguments->more;
    const char **items = malloc((1 + more->count + given.count) * sizeof *items);
    *out = (struct option_list){.items = items};
    for (size_t i = 1; items && i < arguments->operand_count; i++) {
        items[out->count++] = arguments->operands[i];
    }
    for (size_t i = 0; items && i < more->count; i++) {
        items[out->count++] = more->items[i];
    }
    for (size_t i = 0; items && i < given.count; i++) {
        items[out->count++] = given.items[i];
    }
    return items;
}

static int run_connect(const void *given, const struct arguments *arguments)
{
    struct connect_settings settings = *(const struct connect_settings *)given;
    struct connect connect = {.settings = &settings};
    if (!ends_check(&settings.ends, arguments)) {
        return EXIT_USAGE;
    }
    const char **tractograms = list_tractograms(&settings.request.atlas.streamlines, arguments);
    int code = tractograms ? request_init(&connect.request, &settings.request, arguments) : print_no_memory();
    connect.request.atlases.shares_streamlines = true;
    code = code ? code : answer_connect(&connect);
    request_finish(&connect.request);
    free((void *)tractograms);
    return code;
}

const struct command cmd_connect = {
    .name = "connect",
    .summary = "list which areas the streamlines of bundles connect",
    .operands = {"ATLAS", "FILE"},
    .holds = {HOLDS_ATLAS, HOLDS_TRACTS},
    .optional_last = true,
    .repeats = true,
    .description =
        "FILE is a tractogram, with the keys of --streamlines behind it if need be; it is left out where ATLAS has\n"
        "bundles. Finds the areas at both ends of every streamline and reports for each bundle and pair of areas how\n"
        "many streamlines connect them and how long these are. An end in no area has the nearest one within\n"
        "--endpoint-radius. The streamlines are those of every --atlas, too. conus query --endpoints does so for the\n"
        "streamlines in a cone or ball.",
    .examples = "  conus connect aal arcuate.trk\n"
                "  conus connect aal whole.tck -o rows.tsv --connectivity matrix.tsv\n"
                "  conus connect aal whole.tck --only @areas.txt --connectivity matrix.tsv\n"
                "  conus connect aal whole.tck --atlas brodmann -o rows.tsv\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct connect_settings),
    .run = run_connect,
};
