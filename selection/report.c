/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/report.h"

#include "base/memory.h"
#include "base/text.h"

#include <string.h>

conus_status conus_report_create(conus_report **out, const conus_selector *selector,
                                 const conus_report_options *options)
{
    conus_report *report = memory_zeroed(1, sizeof *report);
    if (!report) {
        return CONUS_ERROR_MEMORY;
    }
    report->atlas = selector->atlas;
    report->selector = selector->options;
    report->score = selector->score->info.name;
    report->options = options ? *options : (conus_report_options){0};
    memcpy(report->engine, selector->engine->name, sizeof report->engine);
    report->level = selector->level_spec ? memory_text(selector->level_spec, strlen(selector->level_spec)) : NULL;
    if (selector->level_spec && !report->level) {
        memory_free(report);
        return CONUS_ERROR_MEMORY;
    }
    *out = report;
    return CONUS_OK;
}

void conus_report_destroy(conus_report *report)
{
    if (!report) {
        return;
    }
    for (size_t i = 0; i < report->query_count; i++) {
        memory_free(report->queries[i].id);
    }
    memory_free(report->level);
    memory_free(report->queries);
    memory_free(report->rows);
    buffer_finish(&report->voxels);
    buffer_finish(&report->text);
    memory_free(report);
}

/* Room for `count` elements in an array that doubles, so that adding n queries costs O(n). The array stays as it was
 * where there is no memory. */
static conus_status reserve(void **array, size_t *capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return CONUS_OK;
    }
    size_t wanted = count > 2 * *capacity ? count : 2 * *capacity;
    void *larger = memory_resize(*array, wanted, size);
    if (!larger) {
        return CONUS_ERROR_MEMORY;
    }
    *array = larger;
    *capacity = wanted;
    return CONUS_OK;
}

static conus_status append_query(conus_report *report, const char *id, const conus_selection *selection)
{
    void *queries = report->queries;
    conus_status status = reserve(&queries, &report->query_capacity, report->query_count + 1, sizeof *report->queries);
    report->queries = queries;
    struct report_query query = {.cone = selection->cone};
    query.id = status ? NULL : text_to_utf8(text_from(id));
    if (!query.id) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < selection->statistics.count; i++) {
        query.cone_pixels += selection->statistics.results[i].pixels;
    }
    report->queries[report->query_count++] = query;
    return CONUS_OK;
}

static conus_status append_rows(conus_report *report, const conus_selection *selection)
{
    size_t count = selection->statistics.count;
    void *rows = report->rows;
    conus_status status = reserve(&rows, &report->row_capacity, report->row_count + count, sizeof *report->rows);
    report->rows = rows;
    for (size_t i = 0; !status && i < count; i++) {
        report->rows[report->row_count++] =
            (struct report_row){report->query_count - 1, selection->statistics.results[i]};
    }
    return status;
}

conus_status conus_report_add(conus_report *report, const char *query_id, const conus_selection *selection)
{
    conus_status status = append_query(report, query_id, selection);
    status = status ? status : append_rows(report, selection);
    return status ? status : report_add_voxels(report, selection);
}

static void write_cell(struct buffer *out, struct cell cell)
{
    switch (cell.type) {
    case CELL_NONE:
        buffer_text(out, "n/a");
        break;
    case CELL_TEXT:
        buffer_text(out, cell.text);
        break;
    case CELL_INTEGER:
        buffer_format(out, "%llu", (unsigned long long)cell.integer);
        break;
    case CELL_NUMBER:
        buffer_number(out, cell.number);
        break;
    }
}

static void write_tsv(struct buffer *out, const conus_report *report)
{
    const char *tab = "";
    for (const struct report_column *column = NULL; (column = report_next_column(report, column));) {
        buffer_format(out, "%s%s", tab, column->name);
        tab = "\t";
    }
    buffer_text(out, "\n");
    for (size_t i = 0; i < report->row_count; i++) {
        tab = "";
        for (const struct report_column *column = NULL; (column = report_next_column(report, column));) {
            buffer_text(out, tab);
            tab = "\t";
            write_cell(out, column->get(report, &report->rows[i]));
        }
        buffer_text(out, "\n");
    }
}

/* Hands out report->text, which a writer has filled. */
static conus_status hand_out(conus_report *report, conus_status status, const char **text, size_t *size)
{
    status = status ? status : buffer_status(&report->text);
    if (!status) {
        *text = report->text.data ? report->text.data : "";
        *size = report->text.size;
    }
    return status;
}

conus_status conus_report_text(conus_report *report, const char **text, size_t *size)
{
    conus_status status = CONUS_OK;
    buffer_finish(&report->text);
    switch (report->options.format) {
    case CONUS_TABLE:
        report_write_table(&report->text, report);
        break;
    case CONUS_TSV:
        write_tsv(&report->text, report);
        break;
    case CONUS_JSON:
        status = report_write_json(&report->text, report);
        break;
    case CONUS_NDJSON:
        status = report_write_ndjson(&report->text, report);
        break;
    }
    return hand_out(report, status, text, size);
}

conus_status conus_report_voxels(conus_report *report, const char **text, size_t *size)
{
    buffer_finish(&report->text);
    buffer_text(&report->text, "query\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm\tkind\tindex\n");
    buffer_append(&report->text, report->voxels.data, report->voxels.size);
    return hand_out(report, buffer_status(&report->voxels), text, size);
}

conus_status conus_report_sidecar(conus_report *report, const char **text, size_t *size)
{
    buffer_finish(&report->text);
    return hand_out(report, report_write_sidecar(&report->text, report), text, size);
}
