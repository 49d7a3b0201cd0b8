/* SPDX-License-Identifier: BSD-3-Clause */
/* Hands out the text of a report: calls the writer of its format, and keeps the text. */
#include "selection/report/report.h"

#include "base/memory.h"
#include "conus/own.h"
#include "selection/report/parts.h"

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

typedef void table_writer(struct buffer *out, const conus_report *report);

static table_writer *table_of(const conus_report *report)
{
    return report->options.tracker                                      ? report_write_track
           : report->kind == ROWS_ANSWERS                               ? report_write_table
           : report->kind == ROWS_CLUSTERS                              ? report_write_clusters
           : report->kind == ROWS_NEEDLES || report->kind == ROWS_PAIRS ? report_write_plan
           : report->fields                                             ? report_write_study
           : report->plan.count > 0                                     ? report_write_plan
                                                                        : report_write_shares;
}

static conus_status write_table(struct buffer *out, const conus_report *report)
{
    table_of(report)(out, report);
    return CONUS_OK;
}

const struct report_format report_format_table = {.part = write_table};

#define ADDRESS_OF(number, name, word, facts) &report_format_##name,
static const struct report_format *const formats[] = {REPORT_FORMATS(ADDRESS_OF)};

static const struct report_format *format_of(const conus_report *report)
{
    return formats[report->as];
}

conus_status report_write_part(struct buffer *out, const conus_report *report)
{
    return format_of(report)->part(out, report);
}

void report_write_header(struct buffer *out, const conus_report *report)
{
    if (format_of(report)->header) {
        format_of(report)->header(out, report);
    }
}

static conus_status check_joined(const conus_report *report)
{
    for (const conus_report *of = report->next; of; of = of->next) {
        if (of->query_count != report->query_count) {
            return fail(CONUS_ERROR_ARGUMENT, "report: atlas %s was asked %zu queries, atlas %s %zu", of->name,
                        of->query_count, report->name, report->query_count);
        }
    }
    return CONUS_OK;
}

/* How words were understood comes first, for people. */
static void write_places(struct buffer *out, const conus_report *report)
{
    bool is_table = report->as == REPORT_TABLE;
    for (size_t i = 0; i < report->options.place_count && is_table; i++) {
        const conus_named_place *named = &report->options.places[i];
        char text[CONUS_PLACE_TEXT] = "";
        if (!named->is_sentence) {
            conus_place_text(text, &named->place, &report->frame);
        }
        buffer_format(out, "%s%s%s\n", named->option, *named->option ? " " : "",
                      named->is_sentence ? named->text : text);
    }
}

static conus_status write_text(conus_report *report)
{
    conus_status status = check_joined(report);
    if (status) {
        return status;
    }
    buffer_finish(&report->text);
    if (format_of(report)->whole) {
        return format_of(report)->whole(&report->text, report);
    }
    if (!report->is_begun) {
        write_places(&report->text, report);
        report_write_header(&report->text, report);
    }
    return report_write_part(&report->text, report);
}

conus_status conus_report_text(const char **text, size_t *size, conus_report *report)
{
    conus_status status = write_text(report);
    size_t rows = report->electrode_line_count ? report->electrode_line_count - 1 : 0;
    if (!status && rows > report->taken + report->query_count) {
        status = fail(CONUS_ERROR_DATA, "electrodes: %zu rows, more than answers", rows);
    }
    return hand_out(report, status, text, size);
}

conus_status conus_report_take(const char **text, size_t *size, conus_report *report)
{
    if (format_of(report)->whole || conus_format_at(report->as)->is_of_probe) {
        return fail(CONUS_ERROR_ARGUMENT, "format: this one is written as a whole; NDJSON can be taken in parts");
    }
    conus_status status = hand_out(report, write_text(report), text, size);
    for (conus_report *of = report; of && !status; of = of->next) {
        of->is_begun = true;
        of->taken += of->query_count;
        report_clear(of);
    }
    return status;
}

conus_status conus_report_voxels(const char **text, size_t *size, conus_report *report)
{
    conus_status status = check_joined(report);
    if (status) {
        return status;
    }
    buffer_finish(&report->text);
    const conus_row_marks *marks = report_marks(report);
    buffer_format(&report->text, "query%s%s\tpathway\ti\tj\tk\tx\ty\tz\tvalue\tdistance_mm\tkind\tindex\n",
                  report->name ? "\tatlas" : "", marks && marks->has_number ? "\trow" : "");
    for (size_t query = 0; query < report->query_count; query++) {
        for (const conus_report *of = report; of && !status; of = of->next) {
            size_t first = of->queries[query].first_voxel;
            size_t end = query + 1 < of->query_count ? of->queries[query + 1].first_voxel : of->voxels.size;
            status = buffer_status(&of->voxels);
            if (!status && end > first) {
                buffer_append(&report->text, of->voxels.data + first, end - first);
            }
        }
    }
    return hand_out(report, status, text, size);
}

/* Lays the pairs out, area by area. */
static conus_status fill_matrix(struct report_matrix *out, const conus_table *table)
{
    enum { AREA_LIMIT = 8192 };
    *out = (struct report_matrix){.areas = conus_table_part(table, "areas"), .pairs = conus_table_part(table, "pairs")};
    if (!out->pairs) {
        return fail(CONUS_ERROR_ARGUMENT, "report: a table of areas is of connections with their pairs");
    }
    const int64_t *a = conus_table_counts(out->pairs, "area_a");
    const int64_t *b = conus_table_counts(out->pairs, "area_b");
    out->count = conus_table_rows(out->areas);
    if (out->count - 1 > AREA_LIMIT) {
        return fail(
            CONUS_ERROR_UNSUPPORTED,
            "connectivity: a table of %zu areas, allowed are up to %d; a level has fewer, and so have areas that "
            "are named",
            out->count - 1, AREA_LIMIT);
    }
    out->pair = memory_zeroed(out->count * out->count, sizeof *out->pair);
    for (size_t i = 0; i < conus_table_rows(out->pairs) && out->pair; i++) {
        out->pair[(size_t)a[i] * out->count + (size_t)b[i]] = (uint32_t)i + 1;
        out->pair[(size_t)b[i] * out->count + (size_t)a[i]] = (uint32_t)i + 1;
    }
    return out->pair ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status write_matrix(conus_report *report, const conus_table *table)
{
    struct report_matrix matrix;
    const enum report_number format = report->as;
    if (report->kind != ROWS_CONNECTIONS || (format != REPORT_TSV && format != REPORT_CSV && format != REPORT_JSON)) {
        return fail(CONUS_ERROR_ARGUMENT, "report: a table of areas is of connections, as TSV, CSV or JSON");
    }
    conus_status status = report_check_table(report, table);
    status = status ? status : fill_matrix(&matrix, table);
    if (status) {
        return status;
    }
    buffer_finish(&report->text);
    if (format == REPORT_JSON) {
        status = report_write_json_matrix(&report->text, report, &matrix);
    } else {
        report_write_matrix(&report->text, report, &matrix);
    }
    memory_free(matrix.pair);
    return status;
}

conus_status conus_report_matrix(const char **text, size_t *size, conus_report *report, const conus_table *table)
{
    return hand_out(report, write_matrix(report, table), text, size);
}

conus_status conus_report_probes(const char **text, size_t *size, conus_report *report)
{
    buffer_finish(&report->text);
    return hand_out(report, report_write_probes(&report->text, report), text, size);
}

conus_status conus_report_coordsystem(const char **text, size_t *size, conus_report *report)
{
    buffer_finish(&report->text);
    return hand_out(report, report_write_coordsystem(&report->text, report), text, size);
}

conus_status conus_report_sidecar(const char **text, size_t *size, conus_report *report)
{
    buffer_finish(&report->text);
    return hand_out(report, report_write_sidecar(&report->text, report), text, size);
}

conus_status conus_report_grid_sidecar(const char **text, size_t *size, conus_report *report, const conus_grid *grid)
{
    buffer_finish(&report->text);
    return hand_out(report, report_write_grid_sidecar(&report->text, report, grid), text, size);
}
