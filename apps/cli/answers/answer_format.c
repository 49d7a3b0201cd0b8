/* SPDX-License-Identifier: BSD-3-Clause */
/* The options --format and --output. */
#include "cli/answers/answers.h"

#include "base/path.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"

#include <stdlib.h>
#include <string.h>

static const char *name_of_any(size_t index)
{
    const conus_format_info *info = conus_format_at(index);
    return info ? info->name : NULL;
}

/* Those of other programs are behind all others. */
static const char *name_of_own(size_t index)
{
    const conus_format_info *info = conus_format_at(index);
    return info && !info->is_foreign ? info->name : NULL;
}

const struct option format_options[] = {
    {OPTION_VALUED("format", struct answer_settings, format, "FORMAT"),
     .help = "format of the answer:", .otherwise = "by the ending of -o, else table", .choice_at = name_of_own,
     .words = "CSV, pandas", .role = OPTION_KEPT},
    {0},
};

const struct option query_format_options[] = {
    {OPTION_VALUED("format", struct answer_settings, format, "FORMAT"),
     .help = "format of the answer; those behind ndjson are for other programs (docs/formats.md):",
     .otherwise = "by the ending of -o, else table", .choice_at = name_of_any, .words = "CSV, pandas",
     .role = OPTION_KEPT},
    {0},
};

const struct option answer_output_options[] = {
    {OPTION_VALUED("output", struct answer_settings, output, "FILE"), .letter = 'o',
     .help = "write the answer to FILE; a .json beside it describes its columns, settings and sources",
     .words = "save, export, Excel", .common = true, .role = OPTION_WRITES_ANSWER, .format = "table",
     .holds = HOLDS_ROWS},
    {OPTION_VALUED("sidecar", struct answer_settings, sidecar, "FILE.json|none"),
     .help = "write that .json to FILE.json, also of an answer on standard output; none: no .json beside any file",
     .role = OPTION_WRITES_SIDECAR, .holds = HOLDS_SIDECAR},
    {OPTION_NAMED("force", struct answer_settings, force), .help = "replace files that are there already",
     .role = OPTION_OF_RUN},
    {0},
};

bool answer_format(const char **out, const struct arguments *arguments, const struct answer_settings *settings)
{
    *out = conus_format_at(settings->format)->name;
    if (option_given(arguments, "format") || output_is_no_file(settings->output)) {
        return true;
    }
    return output_format(out, settings->output) ||
           refuse("%s: --output ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for people, .txt; "
                  "--format says what else is written",
                  settings->output);
}

int answer_check_no_sidecar(const char *path)
{
    return path && system_allows(path, 0)
               ? print_usage_error("--sidecar none: %s is there, and would describe another answer", path)
               : EXIT_DONE;
}

int answer_sidecar(char **out, const char *format, const struct answer_settings *settings)
{
    const char *given = settings->sidecar;
    const char *output = settings->output;
    *out = NULL;
    if (sidecar_is_none(given)) {
        char *path = output_is_stdout(output) ? NULL : provenance_path(output);
        int code = answer_check_no_sidecar(path);
        free(path);
        return code;
    }
    if (given && format_is(format, "json")) {
        return print_usage_error("--sidecar has no effect with JSON, which says everything itself");
    }
    if (given && (output_is_stdout(given) || !path_ends_in(given, ".json"))) {
        return print_usage_error("--sidecar: \"%s\" does not end in .json", given);
    }
    if ((!given && (!output || output_is_no_file(output))) || format_is(format, "json")) {
        return EXIT_DONE;
    }
    *out = given ? strdup(given) : provenance_path(output);
    if (!*out) {
        return print_no_memory();
    }
    return EXIT_DONE;
}

int answer_check_names(const char *format, const struct outputs *outputs, const struct arguments *arguments,
                       const struct atlases *atlases)
{
    bool is_recorded = false;
    int code = EXIT_DONE;
    for (size_t i = 0; i < outputs->count; i++) {
        is_recorded = is_recorded || outputs->items[i].is_sidecar || format_is(format, "json");
    }
    for (int i = 1; is_recorded && i < arguments->count && !code; i++) {
        code = outputs_check_name(arguments->words[i]);
    }
    return !is_recorded || code ? code : atlases_check_names(atlases);
}
