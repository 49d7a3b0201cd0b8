/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of rows beside an answer, or in its place. */
#include "cli/answers/answers.h"

#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>
#include <string.h>

static conus_status find_segments(conus_table **out, conus_selector *selector, const struct rows_file *file,
                                  const struct asked *asked)
{
    (void)file;
    return conus_segments(out, selector, asked->pose);
}

static conus_status find_clearance(conus_table **out, conus_selector *selector, const struct rows_file *file,
                                   const struct asked *asked)
{
    return conus_clearance(out, selector, asked->pose, file->within);
}

static conus_status find_ends(conus_table **out, conus_selector *selector, const struct rows_file *file,
                              const struct asked *asked)
{
    (void)file;
    return conus_connectivity(out, selector, asked->selection, asked->radius, asked->pairs);
}

static conus_status find_clusters(conus_table **out, conus_selector *selector, const struct rows_file *file,
                                  const struct asked *asked)
{
    (void)file;
    return conus_clusters(out, selector, asked->roi);
}

static conus_status add_plan(conus_report *report, const struct asked *asked)
{
    return conus_report_add_plan(report, asked->plan);
}

static conus_status add_profile(conus_report *report, const struct asked *asked)
{
    return conus_report_add_profile(report, asked->plan, asked->step);
}

static conus_status add_tolerance(conus_report *report, const struct asked *asked)
{
    return conus_report_add_tolerance(report, asked->plan, &asked->pivot);
}

static conus_status add_pairs(conus_report *report, const struct asked *asked)
{
    return conus_report_add_together(report, asked->together);
}

const struct rows_kind rows_kinds[ROWS_KINDS] = {
    {"segments", "segments", "axis", .study = find_segments},
    {"clearance", "clearances", "axis", .study = find_clearance},
    {"endpoints", "connections", .needs_file = true, .study = find_ends},
    {"connectivity", "connections", .is_matrix = true, .study = find_ends},
    {"clusters", "clusters", .needs_file = true, .study = find_clusters},
    {"constraints", "constraints", "axis", .add = add_plan},
    {"profile", "profile", "axis", .add = add_profile},
    {"tolerance", "tolerance", "axis", .add = add_tolerance},
    {"pairs", "pairs", "axis", .add = add_pairs},
};

/* The format is by the ending, where that is a file. */
static int find_format(struct rows_file *file)
{
    const char *option = file->kind->option;
    bool is_known = output_format(&file->format, file->path);
    if (file->kind->is_matrix) {
        bool is_fit = is_known && (format_is(file->format, "tsv") || format_is(file->format, "csv") ||
                                   format_is(file->format, "json"));
        return is_fit ? EXIT_DONE
                      : print_usage_error("%s: --%s ends in none of .tsv, .csv and .json", file->path, option);
    }
    if (file->kind->needs_file && output_is_stdout(file->path)) {
        return print_usage_error("--%s needs a file: the answer is on standard output", option);
    }
    if (!is_known && !output_is_no_file(file->path)) {
        return print_usage_error("%s: --%s ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for "
                                 "people, .txt",
                                 file->path, option);
    }
    return format_of(file->format)->is_foreign
               ? print_usage_error(
                     "--format: formats of other programs hold no %s; table, tsv, csv, json and ndjson do", option)
               : EXIT_DONE;
}

static int find_sidecar(struct rows_file *file, const char *given)
{
    const struct answer_settings answer = {.output = file->path, .sidecar = sidecar_is_none(given) ? given : NULL};
    return file->kind->is_matrix ? EXIT_DONE : answer_sidecar(&file->sidecar, file->format, &answer);
}

int rows_files_init(struct rows_files *out, const struct arguments *arguments, const char *output, const char *format)
{
    const char *sidecar = option_text(arguments, "sidecar"); /* none is of the rows, too */
    const char *on_stdout = NULL;
    int code = EXIT_DONE;
    for (size_t i = 0; i < ROWS_KINDS && !code; i++) {
        const struct rows_kind *kind = &rows_kinds[i];
        const char *path = option_text(arguments, kind->option);
        if (!path) {
            continue;
        }
        struct rows_file *file = &out->items[out->count++];
        *file = (struct rows_file){.kind = kind,
                                   .path = path,
                                   .within = option_key_number(arguments, "clearance", CLEARANCE_WITHIN),
                                   .format = kind->needs_file || !output_is_stdout(output) ? "table" : format};
        code = find_format(file);
        code = code ? code : find_sidecar(file, sidecar);
        if (!code && on_stdout && output_is_stdout(path)) {
            code = print_usage_error("--%s and --%s are both on standard output", on_stdout, kind->option);
        }
        on_stdout = output_is_stdout(path) ? kind->option : on_stdout;
    }
    out->replace = on_stdout && output_is_stdout(output);
    return code || !out->replace || !sidecar || sidecar_is_none(sidecar)
               ? code
               : print_usage_error("--sidecar has no effect without the answer");
}

void rows_files_finish(struct rows_files *files)
{
    for (size_t i = 0; i < files->count; i++) {
        struct rows_file *file = &files->items[i];
        for (size_t k = 0; k < file->count; k++) {
            conus_report_destroy(file->reports[k]);
        }
        free((void *)file->reports);
        free(file->sidecar);
    }
    *files = (struct rows_files){0};
}

static conus_status add_report(struct rows_file *file, const conus_selector *selector,
                               const conus_report_options *options)
{
    const conus_report_options own = {.rows = file->kind->rows,
                                      .within = file->within,
                                      .format = file->format,
                                      .frame = options->frame,
                                      .command = options->command,
                                      .atlas = options->atlas,
                                      .places = options->places,
                                      .place_count = options->place_count,
                                      .marks = options->marks};
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

conus_status rows_files_report(struct rows_files *files, const conus_selector *selector,
                               const conus_report_options *options)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < files->count && !status; i++) {
        status = add_report(&files->items[i], selector, options);
    }
    return status;
}

/* Kinds of one sort of rows have one table. */
static conus_status find_table(struct asked *asked, const struct rows_file *file, conus_selector *selector)
{
    if (asked->made && strcmp(asked->made_of, file->kind->rows) == 0) {
        return CONUS_OK;
    }
    conus_table_destroy(asked->made);
    asked->made = NULL;
    asked->made_of = file->kind->rows;
    return file->kind->study(&asked->made, selector, file, asked);
}

conus_status rows_files_add(struct rows_files *files, size_t index, conus_selector *selector, const char *id,
                            struct asked *asked)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < files->count && !status; i++) {
        struct rows_file *file = &files->items[i];
        conus_report *report = file->reports[index];
        if (file->kind->add) {
            status = file->kind->add(report, asked);
        } else if (file->kind->region && !asked->pose) {
            status = conus_report_add_error(report, id, asked->line, POINT_HAS_NO_AXIS);
        } else {
            status = find_table(asked, file, selector);
            status = status ? status : conus_report_add_table(report, id, asked->made);
            if (!status && asked->lead && strcmp(asked->made_of, "segments") == 0 &&
                conus_table_rows(asked->made) > 1 && !conus_table_objects(asked->made)[0]) {
                *asked->lead = conus_table_numbers(asked->made, "length_mm")[0];
            }
            file->matrix = asked->made;
        }
    }
    conus_table_destroy(asked->made);
    asked->made = NULL;
    return status;
}

conus_status rows_files_refuse(struct rows_files *files, const char *id, size_t line, const char *why)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < files->count; i++) {
        for (size_t k = 0; k < files->items[i].count && !status; k++) {
            status = conus_report_add_error(files->items[i].reports[k], id, line, why);
        }
    }
    return status;
}

/* As JSON with what it rests on. */
static int write_matrix(const struct rows_file *file, const struct provenance *provenance)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = file->matrix ? conus_report_matrix(&text, &size, file->reports[0], file->matrix) : CONUS_OK;
    return status || !text                   ? print_status(status)
           : format_is(file->format, "json") ? answer_write_json(file->path, provenance, text, size)
                                             : output_write(file->path, text, size);
}

int rows_files_write(const struct rows_files *files, const struct provenance *provenance)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < files->count && !code; i++) {
        const struct rows_file *file = &files->items[i];
        struct provenance own = *provenance;
        own.option = file->kind->option;
        own.is_table = false;
        own.question.rows = file->kind->rows;
        own.question.region = file->kind->region ? file->kind->region : own.question.region;
        code = file->kind->is_matrix ? write_matrix(file, &own)
                                     : answer_write(file->reports[0], file->path, file->sidecar, &own);
    }
    return code;
}
