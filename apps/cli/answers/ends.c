/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows beside the answers: --segments, --clearance and --endpoints; and the table of areas of --connectivity. */
#include "cli/answers/ends.h"

#include "cli/answers/answer_format.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>

int rows_file_init(struct rows_file *out, const struct rows_kind *kind, const char *path, conus_format format,
                   const struct arguments *arguments)
{
    *out = (struct rows_file){.kind = kind, .path = path, .format = format};
    if (!path) {
        return EXIT_DONE;
    }
    if (!output_is_no_file(path) && !output_format(&out->format, path)) {
        return print_usage_error("%s: --%s ends in none of .tsv, .csv, .json, .ndjson, .jsonl and, for a table for "
                                 "people, .txt",
                                 path, kind->option);
    }
    if (format_is_foreign(out->format)) {
        return print_usage_error("--format: formats of other programs hold no %s; table, tsv, csv, json and ndjson do",
                                 kind->option);
    }
    const char *given = option_text(arguments, "sidecar");
    return answer_sidecar(&out->sidecar, out->format,
                          &(struct answer_settings){.output = path, .sidecar = sidecar_is_none(given) ? given : NULL});
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
    const conus_report_options own = {.rows = file->kind->rows,
                                      .within = file->within,
                                      .format = file->format,
                                      .frame = options->frame,
                                      .command = options->command,
                                      .atlas = options->atlas,
                                      .places = options->places,
                                      .place_count = options->place_count,
                                      .marks = options->marks};
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
    return print_status(status);
}

int rows_file_write(const struct rows_file *file, const struct provenance *provenance)
{
    if (!file->path) {
        return EXIT_DONE;
    }
    struct provenance own = *provenance;
    own.option = file->kind->option;
    own.is_table = false;
    own.question.rows = file->kind->word;
    bool is_of_axis = file->kind->rows != CONUS_ROWS_CONNECTIONS && file->kind->rows != CONUS_ROWS_CLUSTERS;
    own.question.region = is_of_axis ? "axis" : own.question.region;
    return answer_write(file->reports[0], file->path, file->sidecar, &own);
}

const struct option endpoints_options[] = {
    {OPTION_VALUED("endpoints", struct ends_settings, endpoints, "FILE"),
     .help = "write which areas the streamlines in the cone or ball connect: a row for each bundle and pair of areas",
     .role = OPTION_WRITES_ROWS, .flags = OPTION_OF_REGION, .holds = HOLDS_ROWS},
    {0},
};

const struct option connectivity_options[] = {
    {OPTION_VALUED("connectivity", struct ends_settings, connectivity, "FILE"),
     .help = "write the table, area by area, of how many streamlines connect them: .tsv, .csv, or .json; it has all "
             "areas with voxels or triangles, or those of --only in their order",
     .words = "connectome, matrix", .role = OPTION_WRITES_ROWS,
     .flags = OPTION_OF_REGION | OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE, .holds = HOLDS_ROWS},
    {OPTION_MM("endpoint-radius", struct ends_settings, radius),
     .help = "an end of a streamline that is in no area has the nearest one within this radius, up to 100; 0 = none",
     .standard = "2"},
    {0},
};

bool ends_check(const struct ends_settings *settings, const struct arguments *arguments)
{
    if (option_given(arguments, "endpoint-radius") && !(settings->radius >= 0 && settings->radius <= 100)) {
        return refuse("--endpoint-radius: %g mm, allowed are 0 to 100", settings->radius);
    }
    return true;
}

double ends_radius_of(const struct ends_settings *settings, const struct arguments *arguments)
{
    bool is_given = option_given(arguments, "endpoint-radius");
    return !is_given ? 0 : settings->radius > 0 ? settings->radius : -1;
}

bool ends_check_atlases(const struct atlases *atlases)
{
    bool is_hidden = false;
    for (size_t i = 0; i < atlases->count; i++) {
        const conus_object *object;
        for (uint32_t number = 1; (object = conus_atlas_object(atlases->items[i].atlas, number)); number++) {
            if (object->kind == CONUS_KIND_BUNDLE && !conus_atlas_is_hidden(atlases->items[i].atlas, number)) {
                return true;
            }
            is_hidden = is_hidden || object->kind == CONUS_KIND_BUNDLE;
        }
    }
    return is_hidden ? refuse("all streamlines are hidden: --only names the bundles to keep beside areas")
                     : refuse("there are no streamlines, --streamlines FILE adds some");
}

int matrix_file_init(struct matrix_file *out, const char *path)
{
    *out = (struct matrix_file){.path = path};
    bool is_fit =
        path && output_format(&out->format, path) &&
        (out->format == CONUS_FORMAT_TSV || out->format == CONUS_FORMAT_CSV || out->format == CONUS_FORMAT_JSON);
    return !path || is_fit ? EXIT_DONE
                           : print_usage_error("%s: --connectivity ends in none of .tsv, .csv and .json", path);
}

void matrix_file_finish(struct matrix_file *file)
{
    conus_report_destroy(file->report);
    *file = (struct matrix_file){0};
}

int matrix_file_take(struct matrix_file *file, const conus_selector *selector, const conus_report_options *options,
                     const char *id, conus_table *table)
{
    const conus_report_options own = {
        .rows = CONUS_ROWS_CONNECTIONS, .format = file->format, .frame = options->frame, .command = options->command};
    if (!file->path) {
        return EXIT_DONE;
    }
    conus_status status = conus_report_create(&file->report, selector, &own);
    status = status ? status : conus_report_add_table(file->report, id, table);
    file->table = status ? NULL : table;
    return print_status(status);
}

int matrix_file_write(const struct matrix_file *file, const struct provenance *provenance)
{
    const char *text = NULL;
    size_t size = 0;
    if (!file->table) {
        return EXIT_DONE;
    }
    conus_status status = conus_report_matrix(&text, &size, file->report, file->table);
    if (status) {
        return print_status(status);
    }
    struct provenance own = *provenance;
    own.option = "connectivity";
    own.question.rows = "connections";
    return file->format == CONUS_FORMAT_JSON ? answer_write_json(file->path, &own, text, size)
                                             : output_write(file->path, text, size);
}

int ends_init(struct ends *out, const struct ends_settings *settings, const struct arguments *arguments)
{
    *out = (struct ends){.radius = ends_radius_of(settings, arguments)};
    if (option_given(arguments, "endpoint-radius") && !settings->endpoints && !settings->connectivity) {
        return print_usage_error("--endpoint-radius has no effect without --endpoints or --connectivity");
    }
    if (settings->endpoints && output_is_stdout(settings->endpoints)) {
        return print_usage_error("--endpoints needs a file: the answer is on standard output");
    }
    static const struct rows_kind connections = {"endpoints", CONUS_ROWS_CONNECTIONS, "connections"};
    int code = rows_file_init(&out->rows, &connections, settings->endpoints, CONUS_FORMAT_TABLE, arguments);
    return code ? code : matrix_file_init(&out->matrix, settings->connectivity);
}

void ends_finish(struct ends *ends)
{
    rows_file_finish(&ends->rows);
    matrix_file_finish(&ends->matrix);
}

int ends_add(struct ends *ends, size_t index, const char *id, conus_selector *selector,
             const conus_selection *selection, const conus_report_options *options)
{
    conus_table *table = NULL;
    if (!ends->rows.path && !ends->matrix.path) {
        return EXIT_DONE;
    }
    conus_status status = conus_connectivity(&table, selector, selection, ends->radius, ends->matrix.path);
    if (!status && ends->rows.path) {
        status = conus_report_add_table(ends->rows.reports[index], id, table);
    }
    int code = status ? print_status(status) : matrix_file_take(&ends->matrix, selector, options, id, table);
    conus_table_destroy(table);
    return code;
}

int ends_write(const struct ends *ends, const struct provenance *provenance)
{
    int code = rows_file_write(&ends->rows, provenance);
    return code ? code : matrix_file_write(&ends->matrix, provenance);
}
