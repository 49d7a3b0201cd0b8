/* SPDX-License-Identifier: BSD-3-Clause */
/* conus connect: which areas the streamlines of bundles connect, all of them, without a pose. */
#include "cli/answers/answer_format.h"
#include "cli/answers/ends.h"
#include "cli/commands.h"
#include "common/messages.h"
#include "common/output.h"
#include "settings/atlas_notes.h"

#include <stdlib.h>

struct connect_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct answer_settings answer;
    struct ends_settings ends;
    struct engine_settings engine; /* level only */
};

#define FIELD(member) offsetof(struct connect_settings, member)

static const struct option level_options[] = {
    {.name = "level",
     .type = OPTION_TEXT,
     .offset = FIELD(engine.level),
     .value = "LEVEL",
     .help = "report areas at this depth of the area tree (1 = its roots), or as these areas: names, @FILE"},
    {0},
};

static const struct option_group groups[] = {
    {"What is connected", atlas_options, FIELD(atlas)},
    {"", shown_options, FIELD(atlas)},
    {"", level_options, 0},
    {"", more_atlas_options, FIELD(atlas)},
    {"What is written", format_options, FIELD(answer)},
    {"", answer_output_options, FIELD(answer)},
    {"", connectivity_options, FIELD(ends)},
    {"", quiet_options, FIELD(common)},
    {0},
};

/* What answers for one atlas. */
struct answerer {
    conus_selector *selector;
    conus_report *report; /* the first one's has the others' joined */
};

/* An answer under way. */
struct connect {
    const struct connect_settings *settings;
    const struct arguments *arguments;
    conus_format format;
    char *command_line;
    char *sidecar; /* path; NULL = none */
    struct atlases atlases;
    struct answerer *answerers; /* [atlases.count] */
    struct matrix_file matrix;
};

static void connect_finish(struct connect *connect)
{
    for (size_t i = 0; connect->answerers && i < connect->atlases.count; i++) {
        conus_report_destroy(connect->answerers[i].report);
        conus_selector_destroy(connect->answerers[i].selector);
    }
    matrix_file_finish(&connect->matrix);
    free(connect->answerers);
    atlases_finish(&connect->atlases);
    free(connect->command_line);
    free(connect->sidecar);
}

static conus_report_options report_options(const struct connect *connect, size_t index)
{
    return (conus_report_options){.rows = CONUS_ROWS_CONNECTIONS,
                                  .format = connect->format,
                                  .command = connect->command_line,
                                  .atlas = connect->atlases.items[index].name};
}

/* --level is of the first atlas. */
static conus_status start_answerer(struct connect *connect, size_t index)
{
    struct answerer *answerer = &connect->answerers[index];
    const conus_selector_options selector = {.level = index ? NULL : connect->settings->engine.level,
                                             .engine = CONUS_ENGINE_RAYS};
    const conus_report_options report = report_options(connect, index);
    conus_status status = conus_selector_create(&answerer->selector, connect->atlases.items[index].atlas, &selector);
    status = status ? status : conus_report_create(&answerer->report, answerer->selector, &report);
    return status || !index ? status : conus_report_join(connect->answerers[0].report, answerer->report);
}

static int add_answer(struct connect *connect, size_t index)
{
    const conus_connectivity_options options = ends_options_of(&connect->settings->ends, connect->arguments);
    const conus_report_options report = report_options(connect, index);
    struct answerer *answerer = &connect->answerers[index];
    conus_connectivity *connectivity = NULL;
    conus_status status = conus_connectivity_create(&connectivity, answerer->selector, NULL, &options);
    status = status ? status : conus_report_add_connections(answerer->report, "1", connectivity);
    if (status) {
        conus_connectivity_destroy(connectivity);
        return print_status(status);
    }
    return matrix_file_take(&connect->matrix, answerer->selector, &report, "1", connectivity);
}

static int load_atlases(struct connect *connect)
{
    struct atlases *atlases = &connect->atlases;
    conus_status status = CONUS_OK;
    int code = atlases_load(atlases, connect->arguments->operands[0], &connect->settings->atlas);
    if (code) {
        return code;
    }
    connect->answerers = calloc(atlases->count, sizeof *connect->answerers);
    if (!connect->answerers) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    for (size_t i = 0; i < atlases->count && !status; i++) {
        status = start_answerer(connect, i);
    }
    return status ? print_status(status) : EXIT_DONE;
}

/* Whether no output is a file that is read, or another output. */
static bool check_outputs(const struct connect *connect)
{
    const char *output = connect->settings->answer.output;
    const char *const outputs[] = {output_is_stdout(output) ? NULL : output, connect->sidecar, connect->matrix.path};
    static const char *const names[] = {"--output", "the .json beside --output", "--connectivity"};
    const struct input inputs[] = {{"the label table", connect->settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&connect->settings->engine)},
                                   {0}};
    for (size_t i = 0; i < 3; i++) {
        const char *input = outputs[i] ? atlases_input(&connect->atlases, inputs, outputs[i]) : NULL;
        if (input) {
            print_error_line("%s would overwrite %s %s", names[i], input, outputs[i]);
            return false;
        }
        for (size_t j = 0; outputs[i] && j < i; j++) {
            if (outputs[j] && paths_equal(outputs[i], outputs[j])) {
                print_error_line("%s and %s are the same file %s", names[j], names[i], outputs[i]);
                return false;
            }
        }
    }
    return true;
}

static int answer(struct connect *connect)
{
    const struct connect_settings *settings = connect->settings;
    int code = load_atlases(connect);
    if (!code && (!check_outputs(connect) || !ends_check_atlases(&connect->atlases))) {
        return EXIT_USAGE;
    }
    for (size_t i = 0; !code && i < connect->atlases.count; i++) {
        code = add_answer(connect, i);
    }
    if (code) {
        return code;
    }
    atlases_say_notes(&connect->atlases, &settings->common);
    atlases_say_spaces(&connect->atlases, &settings->common);
    struct provenance provenance = {0};
    provenance_add_input(&provenance, settings_level_file(&settings->engine));
    code = matrix_file_write(&connect->matrix, &provenance);
    provenance_add_output(&provenance, "connectivity", connect->matrix.path, NULL, 0);
    return code ? code
                : answer_write(connect->answerers[0].report, settings->answer.output, connect->sidecar, &provenance);
}

static int run_connect(const void *given, const struct arguments *arguments)
{
    const struct connect_settings *settings = given;
    struct connect connect = {.settings = settings, .arguments = arguments};
    if (!ends_check(&settings->ends, arguments) || !answer_format(&connect.format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    connect.command_line = arguments_text(arguments);
    if (!connect.command_line) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    int code = answer_sidecar(&connect.sidecar, connect.format, &settings->answer);
    code = code ? code : matrix_file_init(&connect.matrix, settings->ends.connectivity);
    code = code ? code : answer(&connect);
    connect_finish(&connect);
    return code;
}

const struct command cmd_connect = {
    .name = "connect",
    .summary = "list which areas the streamlines of bundles connect",
    .operands = {"ATLAS"},
    .description =
        "Finds the areas at both ends of every streamline of --streamlines and reports for each bundle and pair of\n"
        "areas how many streamlines connect them and how long these are. An end in no area has the nearest one\n"
        "within --endpoint-radius. conus query --endpoints does so for the streamlines in a cone or ball.",
    .examples = "  conus connect aal --streamlines arcuate.trk\n"
                "  conus connect aal --streamlines whole.tck -o rows.tsv --connectivity matrix.tsv\n",
    .groups = groups,
    .settings_size = sizeof(struct connect_settings),
    .run = run_connect,
};
