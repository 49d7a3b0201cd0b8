/* SPDX-License-Identifier: BSD-3-Clause */
/* conus connect: which areas the streamlines of bundles connect, all of them, without a pose. */
#include "cli/answers/ends.h"
#include "cli/commands.h"
#include "cli/survey.h"
#include "options/messages.h"

#include <stdlib.h>

struct connect_settings {
    struct survey_settings survey; /* first */
    struct ends_settings ends;
};

static const struct option_group groups[] = {
    {"What is connected", atlas_options, SURVEY_FIELD(atlas)},
    SURVEY_ATLAS_GROUPS,
    SURVEY_OUTPUT_GROUPS,
    {"", connectivity_options, offsetof(struct connect_settings, ends)},
    {"", quiet_options, SURVEY_FIELD(common)},
    {0},
};

/* An answer under way. */
struct connect {
    const struct connect_settings *settings;
    struct survey survey;
    struct matrix_file matrix;
};

static const conus_report_options rows = {.rows = CONUS_ROWS_CONNECTIONS};

static int add_answer(struct connect *connect, size_t index)
{
    const conus_connectivity_options options = ends_options_of(&connect->settings->ends, connect->survey.arguments);
    const conus_report_options report = survey_report_options(&connect->survey, &rows, index);
    struct surveyor *surveyor = &connect->survey.surveyors[index];
    conus_connectivity *connectivity = NULL;
    conus_status status = conus_connectivity_create(&connectivity, surveyor->selector, NULL, &options);
    status = status ? status : conus_report_add_connections(surveyor->report, "1", connectivity);
    if (status) {
        conus_connectivity_destroy(connectivity);
        return print_status(status);
    }
    return matrix_file_take(&connect->matrix, surveyor->selector, &report, "1", connectivity);
}

static int answer(struct connect *connect)
{
    struct survey *survey = &connect->survey;
    struct provenance provenance = {0};
    int code = survey_load(survey);
    code = code ? code : survey_start(survey, &rows);
    code = code ? code : survey_check_outputs(survey);
    code = code || ends_check_atlases(&survey->atlases) ? code : EXIT_USAGE;
    for (size_t i = 0; !code && i < survey->atlases.count; i++) {
        code = add_answer(connect, i);
    }
    if (code) {
        return code;
    }
    survey_describe(survey, &provenance, "connections", "all");
    code = matrix_file_write(&connect->matrix, &provenance);
    provenance_add_outputs(&provenance, survey->arguments);
    return code ? code : survey_write(survey, &provenance);
}

static int run_connect(const void *given, const struct arguments *arguments)
{
    const struct connect_settings *settings = given;
    struct connect connect = {.settings = settings};
    if (!ends_check(&settings->ends, arguments)) {
        return EXIT_USAGE;
    }
    int code = survey_init(&connect.survey, &settings->survey, arguments);
    code = code ? code : matrix_file_init(&connect.matrix, settings->ends.connectivity);
    code = code ? code : answer(&connect);
    matrix_file_finish(&connect.matrix);
    survey_finish(&connect.survey);
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
    .answers = true,
    .family = commands,
    .groups = groups,
    .settings_size = sizeof(struct connect_settings),
    .run = run_connect,
};
