/* SPDX-License-Identifier: BSD-3-Clause */
/* conus connect: which areas the streamlines of bundles connect, all of them, without a pose. */
#include "cli/answers/ends.h"
#include "cli/commands.h"
#include "cli/request.h"
#include "options/messages.h"

#include <stdlib.h>

struct connect_settings {
    struct request_settings request; /* first */
    struct ends_settings ends;
};

static const struct option_group groups[] = {
    {"What is connected", atlas_options, REQUEST_FIELD(atlas)},
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
    struct matrix_file matrix;
};

static int add_answer(struct connect *connect, size_t index, const conus_report_options *report)
{
    const conus_connectivity_options options = ends_options_of(&connect->settings->ends, connect->request.arguments);
    struct answerer *answerer = &connect->request.answerers[index];
    conus_connectivity *connectivity = NULL;
    conus_status status = conus_connectivity_create(&connectivity, answerer->selector, NULL, &options);
    status = status ? status : conus_report_add_connections(answerer->report, "1", connectivity);
    if (status) {
        conus_connectivity_destroy(connectivity);
        return print_status(status);
    }
    return matrix_file_take(&connect->matrix, answerer->selector, report, "1", connectivity);
}

static int answer_connect(struct connect *connect)
{
    struct request *request = &connect->request;
    struct provenance provenance = {0};
    conus_report_options report = request_report_options(request);
    report.rows = CONUS_ROWS_CONNECTIONS;
    report.frame = NULL; /* its rows have no positions */
    int code = request_load_atlases(request);
    code = code ? code : request_start_without_rays(request, &report);
    code = code ? code : request_check_outputs(request);
    code = code || ends_check_atlases(&request->atlases) ? code : EXIT_USAGE;
    for (size_t i = 0; !code && i < request->atlases.count; i++) {
        code = add_answer(connect, i, &report);
    }
    if (code) {
        return code;
    }
    request_say_notes(request);
    request_list_inputs(&provenance, request);
    provenance.question.rows = "connections";
    provenance.question.region = "all";
    code = matrix_file_write(&connect->matrix, &provenance);
    provenance_add_outputs(&provenance, request->arguments);
    return code ? code
                : answer_write(request->answerers[0].report, request->settings->answer.output, request->sidecar,
                               &provenance);
}

static int run_connect(const void *given, const struct arguments *arguments)
{
    const struct connect_settings *settings = given;
    struct connect connect = {.settings = settings};
    if (!ends_check(&settings->ends, arguments)) {
        return EXIT_USAGE;
    }
    int code = request_init(&connect.request, &settings->request, arguments);
    code = code ? code : matrix_file_init(&connect.matrix, settings->ends.connectivity);
    connect.request.atlases.shares_streamlines = true;
    code = code ? code : answer_connect(&connect);
    matrix_file_finish(&connect.matrix);
    request_finish(&connect.request);
    return code;
}

const struct command cmd_connect = {
    .name = "connect",
    .summary = "list which areas the streamlines of bundles connect",
    .operands = {"ATLAS"},
    .description =
        "Finds the areas at both ends of every streamline of --streamlines and reports for each bundle and pair of\n"
        "areas how many streamlines connect them and how long these are. An end in no area has the nearest one\n"
        "within --endpoint-radius. The streamlines are those of every --atlas, too. conus query --endpoints does so\n"
        "for the streamlines in a cone or ball.",
    .examples = "  conus connect aal --streamlines arcuate.trk\n"
                "  conus connect aal --streamlines whole.tck -o rows.tsv --connectivity matrix.tsv\n"
                "  conus connect aal --atlas brodmann --streamlines whole.tck -o rows.tsv\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct connect_settings),
    .run = run_connect,
};
