/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects what axes pass, and writes it. */
#include "cli/answers/segments_file.h"

#include "cli/answers/answer_format.h"
#include "common/messages.h"
#include "common/output.h"

#include <stdlib.h>

int segments_file_init(struct segments_file *out, const char *path, conus_format format)
{
    *out = (struct segments_file){.path = path, .format = format};
    if (!path) {
        return EXIT_DONE;
    }
    if (!output_is_no_file(path) && !output_format(&out->format, path)) {
        return print_usage_error("%s: --segments ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table "
                                 "for people, .txt",
                                 path);
    }
    if (out->format > CONUS_FORMAT_NDJSON) {
        return print_usage_error("--format: other programs' are not of segments, table, tsv, csv, json and ndjson are");
    }
    return answer_sidecar(&out->sidecar, out->format, &(struct answer_settings){.output = path});
}

void segments_file_finish(struct segments_file *file)
{
    for (size_t i = 0; i < file->count; i++) {
        conus_report_destroy(file->reports[i]);
    }
    free((void *)file->reports);
    free(file->sidecar);
    *file = (struct segments_file){0};
}

conus_status segments_file_report(struct segments_file *file, const conus_selector *selector,
                                  const conus_report_options *options)
{
    const conus_report_options own = {.rows = CONUS_ROWS_SEGMENTS,
                                      .format = file->format,
                                      .frame = options->frame,
                                      .command = options->command,
                                      .atlas = options->atlas};
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

int segments_file_add(struct segments_file *file, size_t index, const char *id, conus_selector *selector,
                      const conus_pose *pose)
{
    conus_segments *segments = NULL;
    if (!file->path) {
        return EXIT_DONE;
    }
    conus_status status = conus_segments_create(&segments, selector, pose);
    status = status ? status : conus_report_add_segments(file->reports[index], id, segments);
    conus_segments_destroy(segments);
    return status ? print_status(status) : EXIT_DONE;
}

int segments_file_refuse(struct segments_file *file, const char *id, size_t line, const char *why)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < file->count && !status; i++) {
        status = conus_report_add_error(file->reports[i], id, line, why);
    }
    return status ? print_status(status) : EXIT_DONE;
}

int segments_file_write(const struct segments_file *file, const struct provenance *provenance)
{
    if (!file->path) {
        return EXIT_DONE;
    }
    struct provenance own = *provenance;
    own.option = "segments";
    return answer_write(file->reports[0], file->path, file->sidecar, &own);
}
