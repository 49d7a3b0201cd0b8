/* SPDX-License-Identifier: BSD-3-Clause */
/* From the command line to answers without a pose. */
#include "cli/survey.h"

#include "options/messages.h"
#include "settings/notes.h"

#include <stdlib.h>

const struct option survey_level_options[] = {
    {.name = "level",
     .type = OPTION_TEXT,
     .offset = SURVEY_FIELD(engine.level),
     .value = "LEVEL",
     .help = "report areas at this depth of the area tree (1 = its roots), or as these areas: names, @FILE",
     .words = "hierarchy, ontology",
     .common = true,
     .role = OPTION_READS},
    {0},
};

int survey_init(struct survey *out, const struct survey_settings *settings, const struct arguments *arguments)
{
    *out = (struct survey){.settings = settings, .arguments = arguments};
    if (!answer_format(&out->format, arguments, &settings->answer)) {
        return EXIT_USAGE;
    }
    out->command_line = arguments_text(arguments);
    if (!out->command_line) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    return answer_sidecar(&out->sidecar, out->format, &settings->answer);
}

void survey_finish(struct survey *survey)
{
    for (size_t i = 0; survey->surveyors && i < survey->atlases.count; i++) {
        conus_report_destroy(survey->surveyors[i].report);
        conus_selector_destroy(survey->surveyors[i].selector);
    }
    free(survey->surveyors);
    atlases_finish(&survey->atlases);
    free(survey->command_line);
    free(survey->sidecar);
}

int survey_load(struct survey *survey)
{
    return atlases_load(&survey->atlases, survey->arguments->operands[0], &survey->settings->atlas);
}

conus_report_options survey_report_options(const struct survey *survey, const conus_report_options *rows, size_t index)
{
    conus_report_options options = *rows;
    options.format = survey->format;
    options.command = survey->command_line;
    options.atlas = survey->atlases.items[index].name;
    return options;
}

static conus_status start_surveyor(struct survey *survey, const conus_report_options *rows, size_t index)
{
    struct surveyor *surveyor = &survey->surveyors[index];
    const conus_selector_options selector = {.level = index ? NULL : survey->settings->engine.level,
                                             .engine = CONUS_ENGINE_RAYS};
    const conus_report_options report = survey_report_options(survey, rows, index);
    conus_status status = conus_selector_create(&surveyor->selector, survey->atlases.items[index].atlas, &selector);
    status = status ? status : conus_report_create(&surveyor->report, surveyor->selector, &report);
    return status || !index ? status : conus_report_join(survey->surveyors[0].report, surveyor->report);
}

int survey_start(struct survey *survey, const conus_report_options *rows)
{
    conus_status status = CONUS_OK;
    survey->surveyors = calloc(survey->atlases.count, sizeof *survey->surveyors);
    if (!survey->surveyors) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    for (size_t i = 0; i < survey->atlases.count && !status; i++) {
        status = start_surveyor(survey, rows, i);
    }
    return status ? print_status(status) : EXIT_DONE;
}

int survey_check_outputs(const struct survey *survey)
{
    const struct survey_settings *settings = survey->settings;
    const struct input inputs[] = {{"the label table", settings->atlas.labels},
                                   {"the list of areas", settings_level_file(&settings->engine)},
                                   {0}};
    struct outputs outputs;
    outputs_collect(&outputs, survey->arguments);
    if (!settings->answer.sidecar) {
        outputs_add_sidecar(&outputs, "output", survey->sidecar);
    }
    for (size_t i = 0; i < outputs.count; i++) {
        const char *input = atlases_input(&survey->atlases, inputs, outputs.items[i].path);
        if (input) {
            return print_usage_error("%s would overwrite %s %s", outputs.items[i].what, input, outputs.items[i].path);
        }
    }
    int code = outputs_differ(&outputs)
                   ? answer_check_names(survey->format, &outputs, survey->arguments, &survey->atlases)
                   : EXIT_USAGE;
    return code ? code : outputs_check(&outputs, settings->answer.force);
}

void survey_describe(const struct survey *survey, struct provenance *provenance, const char *rows, const char *region)
{
    provenance->question = (struct question){survey->arguments, rows, region};
    atlases_say_notes(&survey->atlases, &survey->settings->common);
    atlases_say_spaces(&survey->atlases, &survey->settings->common);
    provenance_add_input(provenance, settings_level_file(&survey->settings->engine));
}

int survey_write(const struct survey *survey, const struct provenance *provenance)
{
    return answer_write(survey->surveyors[0].report, survey->settings->answer.output, survey->sidecar, provenance);
}
