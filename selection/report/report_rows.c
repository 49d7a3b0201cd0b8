/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows as text, for tables and for lines of JSON. */
#include "selection/report/report.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { COLUMN_LIMIT = 64 }; /* more than any kind of report has */

struct cell report_cell(const conus_report *report, const struct report_column *column, const struct report_row *row)
{
    const struct report_query *query = &report->queries[row->query];
    if (!query->error) {
        return column->get(report, row);
    }
    const char *reason = report->options.rows == CONUS_SUMMARIES ? "error"
                         : report->options.format == CONUS_BIDS  ? "area_error"
                                                                 : "name";
    const char *text = !strcmp(column->name, "query")  ? query->id
                       : !strcmp(column->name, "kind") ? "error"
                       : !strcmp(column->name, reason) ? query->error
                                                       : NULL;
    return (struct cell){.type = text && text[0] ? CELL_TEXT : CELL_NONE, .text = text};
}

void report_write_cell(struct buffer *out, struct cell cell)
{
    switch (cell.type) {
    case CELL_NONE:
        buffer_append(out, "n/a", 3);
        break;
    case CELL_TEXT:
        buffer_text(out, cell.text);
        break;
    case CELL_INTEGER:
        buffer_whole(out, cell.integer);
        break;
    case CELL_NUMBER:
        buffer_number(out, cell.number);
        break;
    case CELL_TIME:
        buffer_text(out, text_time((char[TEXT_NUMBER_SIZE]){0}, cell.number));
        break;
    }
}

/* What stands between the fields of a table, and behind its lines. */
struct table_marks {
    const char *separator, *end;
};

static struct table_marks marks_of(const conus_report *report)
{
    static const struct table_marks tsv = {"\t", "\n"};
    static const struct table_marks csv = {",", "\r\n"}; /* RFC 4180, section 2 */
    return report->options.format == CONUS_CSV ? csv : tsv;
}

void report_write_heading(struct buffer *out, const conus_report *report)
{
    if (report->options.format == CONUS_BIDS) {
        report_write_electrodes_heading(out, report);
        return;
    }
    if (report->options.format != CONUS_TSV && report->options.format != CONUS_CSV) {
        return;
    }
    const struct table_marks marks = marks_of(report);
    const char *before = "";
    for (const struct report_column *column = NULL; (column = report_next_column(report, column));) {
        buffer_text(out, before);
        buffer_text(out, column->name);
        before = marks.separator;
    }
    buffer_text(out, marks.end);
}

/* The columns of a report, one after the other. */
struct columns {
    const struct report_column *column[COLUMN_LIMIT];
    size_t count;
};

static void list_columns(struct columns *out, const conus_report *report)
{
    out->count = 0;
    for (const struct report_column *column = NULL; (column = report_next_column(report, column));) {
        assert(out->count < COLUMN_LIMIT);
        out->column[out->count++] = column;
    }
}

/* Between quotation marks where it must be, with its own ones doubled. */
static void write_csv_text(struct buffer *out, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        buffer_text(out, text);
        return;
    }
    buffer_append(out, "\"", 1);
    for (const char *mark; (mark = strchr(text, '"')); text = mark + 1) {
        buffer_append(out, text, (size_t)(mark - text));
        buffer_append(out, "\"\"", 2);
    }
    buffer_text(out, text);
    buffer_append(out, "\"", 1);
}

static void write_table_row(struct buffer *out, const conus_report *report, const struct columns *columns,
                            const struct report_row *row)
{
    const struct table_marks marks = marks_of(report);
    for (size_t i = 0; i < columns->count; i++) {
        struct cell cell = report_cell(report, columns->column[i], row);
        if (cell.type == CELL_TEXT && report->options.format == CONUS_CSV) {
            write_csv_text(out, cell.text);
        } else {
            report_write_cell(out, cell);
        }
        buffer_text(out, i + 1 < columns->count ? marks.separator : marks.end);
    }
}

/* As a JSON string; the text is UTF-8. */
static void write_string(struct buffer *out, const char *text)
{
    buffer_append(out, "\"", 1);
    while (*text) {
        size_t plain = 0;
        while ((unsigned char)text[plain] >= 0x20 && text[plain] != '"' && text[plain] != '\\') {
            plain++;
        }
        buffer_append(out, text, plain);
        text += plain;
        if (*text == '"' || *text == '\\') {
            const char escaped[2] = {'\\', *text++};
            buffer_append(out, escaped, 2);
        } else if (*text) {
            buffer_format(out, "\\u%04x", (unsigned)(unsigned char)*text++);
        }
    }
    buffer_append(out, "\"", 1);
}

static void write_json_row(struct buffer *out, const conus_report *report, const struct report_row *row)
{
    const char *before = "{\"";
    for (const struct report_column *column = NULL; (column = report_next_column(report, column));) {
        struct cell cell = report_cell(report, column, row);
        buffer_append(out, before, 2);
        before = ",\"";
        buffer_text(out, column->name);
        buffer_append(out, "\":", 2);
        if (cell.type == CELL_TEXT) {
            write_string(out, cell.text);
        } else if (cell.type == CELL_NONE) {
            buffer_append(out, "null", 4);
        } else {
            report_write_cell(out, cell);
        }
    }
    buffer_append(out, "}\n", 2);
}

bool report_is_shown(const conus_report *report, size_t row)
{
    return report->options.rows != CONUS_SUMMARIES || row == 0 ||
           report->rows[row].query != report->rows[row - 1].query;
}

void report_write_rows(struct buffer *out, const conus_report *report)
{
    struct columns columns;
    list_columns(&columns, report);
    for (size_t i = 0; i < report->row_count; i++) {
        if (!report_is_shown(report, i)) {
            continue;
        }
        if (report->options.format == CONUS_NDJSON) {
            write_json_row(out, report, &report->rows[i]);
        } else {
            write_table_row(out, report, &columns, &report->rows[i]);
        }
    }
}
