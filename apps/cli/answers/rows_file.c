/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects rows beside the answers, and writes them. */
#include "cli/answers/rows_file.h"

#include "cli/answers/answer_format.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdlib.h>

int rows_file_init(struct rows_file *out, const char *option, conus_rows rows, const char *path, conus_format format)
{
    *out = (struct rows_file){.option = option, .rows = rows, .path = path, .format = format};
    if (!path) {
        return EXIT_DONE;
    }
    if (!output_is_no_file(path) && !output_format(&out->format, path)) {
        return print_usage_error("%s: --%s ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for "
                                 "people, .txt",
                                 path, option);
    }
    if (out->format > CONUS_FORMAT_NDJSON) {
        return print_usage_error("--format: other programs' are not of %s, table, tsv, csv, json and ndjson are",
                                 option);
    }
    return answer_sidecar(&out->sidecar, out->format, &(struct answer_settings){.output = path});
}

void rows_file_finish(struct rows_file *file)
{
    for (size_t i = 0; i < file->count; i++) {
        conus_report_destroy(file->reports[i]);
    }
    free((void *)file->reports);
    free(file->sidecar);
    *file = (struct rows_file){0};
}

conus_status rows_file_report(struct rows_file *file, const conus_selector *selector,
                              const conus_report_options *options)
{
    const conus_report_options own = {.rows = file->rows,
                                      .format = file->format,
                                      .frame = options->frame,
                                      .command = options->command,
                                      .atlas = options->atlas};
    if (!file->path) {
        return CONUS_OK;
    }
    conus_report **reports = realloc((void *)file->reports, (file->count + 1) * sizeof(conus_report *));
    if (!reports) {
        return CONUS_ERROR_MEMORY;
    }
    file->reports = reports;
    conus_status status = conus_report_create(&reports[file->count], selector, &own);
    if (status) {
        return status;
    }
    file->count++;
    return file->count > 1 ? conus_report_join(reports[0], reports[file->count - 1]) : CONUS_OK;
}

int rows_file_refuse(struct rows_file *file, const char *id, size_t line, const char *why)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < file->count && !status; i++) {
        status = conus_report_add_error(file->reports[i], id, line, why);
    }
    return status ? print_status(status) : EXIT_DONE;
}

int rows_file_write(const struct rows_file *file, const struct provenance *provenance)
{
    if (!file->path) {
        return EXIT_DONE;
    }
    struct provenance own = *provenance;
    own.option = file->option;
    own.question.rows = file->rows == CONUS_ROWS_SEGMENTS ? "segments" : "connections";
    own.question.region = file->rows == CONUS_ROWS_SEGMENTS ? "axis" : own.question.region;
    return answer_write(file->reports[0], file->path, file->sidecar, &own);
}
