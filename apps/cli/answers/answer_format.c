/* SPDX-License-Identifier: BSD-3-Clause */
/* The options --format and --output, and the writing of a report and its sidecar. */
#include "cli/answers/answer_format.h"

#include "common/messages.h"
#include "common/output.h"

#include <stdlib.h>
#include <string.h>

static const char *const formats[] = {"table", "tsv", "csv", "json", "ndjson", NULL};

const struct option format_options[] = {
    {.name = "format",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct answer_settings, format),
     .value = "FORMAT",
     .help = "format of the answer; default by the ending of -o, else a table:",
     .choices = formats},
    {0},
};

static const char *const query_formats[] = {"table", "tsv",  "csv",      "json",       "ndjson",
                                            "afni",  "bids", "spikeglx", "open-ephys", NULL};

const struct option query_format_options[] = {
    {.name = "format",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct answer_settings, format),
     .value = "FORMAT",
     .help = "format of the answer; default by the ending of -o, else a table; the last four are for other "
             "programs (docs/formats.md):",
     .choices = query_formats},
    {0},
};

const struct option answer_output_options[] = {
    {.name = "output",
     .letter = 'o',
     .type = OPTION_TEXT,
     .offset = offsetof(struct answer_settings, output),
     .value = "FILE",
     .help = "write the answer to FILE; a .json beside a .tsv or .csv describes its columns, settings and sources"},
    {0},
};

bool answer_format(conus_format *out, const struct arguments *arguments, const struct answer_settings *settings)
{
    *out = (conus_format)settings->format;
    if (option_given(arguments, "format") || output_is_no_file(settings->output)) {
        return true;
    }
    return output_format(out, settings->output) ||
           (print_error_line(
                "%s: --output ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for people, .txt; "
                "--format says what else is written",
                settings->output),
            false);
}

bool answer_sidecar(char **out, conus_format format, const char *output)
{
    char *path = NULL;
    bool has_columns = format == CONUS_FORMAT_TSV || format == CONUS_FORMAT_CSV || format == CONUS_FORMAT_BIDS;
    if (!output_is_stdout(output) && has_columns && (path_ends(output, ".tsv") || path_ends(output, ".csv"))) {
        int stem = (int)(strlen(output) - strlen(".tsv"));
        if (asprintf(&path, "%.*s.json", stem, output) < 0) {
            return false;
        }
    }
    *out = path;
    return true;
}

int answer_write_sidecar(conus_report *report, const char *path)
{
    const char *text = NULL;
    size_t size = 0;
    if (!path) {
        return EXIT_DONE;
    }
    conus_status status = conus_report_sidecar(&text, &size, report);
    return status ? print_status(status) : output_write(path, text, size);
}

int answer_write(conus_report *report, const char *path)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_text(&text, &size, report);
    return status ? print_status(status) : output_write(path, text, size);
}
