/* SPDX-License-Identifier: BSD-3-Clause */
/* conus positions: where positions of the 10-10 system are, and how a device stands there. */
#include "cli/commands.h"
#include "cli/request.h"
#include "conus/own.h"
#include "options/messages.h"

#include <stdlib.h>

static const struct option_group groups[] = {
    {"How a device stands there", stance_options, REQUEST_FIELD(aim)},
    {"", scalp_options, REQUEST_FIELD(aim)},
    REQUEST_OUTPUT_GROUPS,
    {"", quiet_options, REQUEST_FIELD(common)},
    {0},
};

/* The names given; NULL: without memory. */
static const char **list_names(size_t *count, const struct arguments *arguments)
{
    const char **names = malloc((arguments->operand_count + arguments->more.count + 1) * sizeof *names);
    for (size_t i = 0; names && i < arguments->operand_count; i++) {
        names[(*count)++] = arguments->operands[i];
    }
    for (size_t i = 0; names && i < arguments->more.count; i++) {
        names[(*count)++] = arguments->more.items[i];
    }
    return names;
}

static int write_positions(const struct request *request, conus_report *report, conus_table *found)
{
    struct provenance provenance = {0};
    int code = print_status(conus_report_add_table(report, "1", found));
    code = code ? code : request_check_outputs(request);
    if (code) {
        return code;
    }
    request_list_inputs(&provenance, request);
    provenance.question.rows = "positions";
    provenance.question.region = "all";
    return answer_write(report, request->settings->answer.output, request->sidecar, &provenance);
}

static int answer_positions(struct request *request, const struct arguments *arguments)
{
    conus_report_options options = request_report_options(request);
    const struct aim_settings *aim = &request->settings->aim;
    conus_position_options stance = settings_stance(aim, arguments);
    conus_table *found = NULL;
    conus_report *report = NULL;
    size_t count = 0;
    const char **names = list_names(&count, arguments);
    if (!names) {
        return print_no_memory();
    }
    options.frame = NULL;
    options.rows = "positions";
    int code = settings_scalp(&request->places.scalp, request->scalp, aim, NULL);
    stance.scalp = request->places.scalp;
    code = code ? code : print_status(conus_positions(&found, count ? names : NULL, count, &stance));
    code = code ? code : print_status(conus_report_create(&report, NULL, &options));
    code = code ? code : write_positions(request, report, found);
    conus_report_destroy(report);
    conus_table_destroy(found);
    free((void *)names);
    return code;
}

static int run_positions(const void *given, const struct arguments *arguments)
{
    struct request request;
    int code = request_init(&request, given, arguments);
    code = code ? code : answer_positions(&request, arguments);
    request_finish(&request);
    return code;
}

const struct command cmd_positions = {
    .name = "positions",
    .summary = "list where positions of the 10-10 system are, as poses straight into the head",
    .operands = {"NAME"},
    .optional = true,
    .repeats = true,
    .description = "Lists positions of the 10-10 system (C3, Fp1, ...) on the head of MNI 152, or with --scalp on "
                   "somebody's own,\n"
                   "all or those named, as a table of poses: where each is, straight into the head, the device's up, "
                   "and how far off people's heads are. conus\n"
                   "query --pose and conus sweep --jitter columns read it.",
    .examples = "  conus positions C3 F3 P3 -o cap.tsv\n"
                "  conus positions C3 --handle 45 --format tsv\n"
                "  conus positions | head\n",
    .see_also = "  conus query     what lies below one: --origin C3 --inward\n",
    .answers = true,
    .groups = groups,
    .settings_size = sizeof(struct request_settings),
    .run = run_positions,
};
