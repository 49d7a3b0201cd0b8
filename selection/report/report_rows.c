/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows as text, for tables and for lines of JSON. */
#include "selection/report/parts.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

inline void report_write_cell(struct buffer *out, struct cell cell) /* called for each cell of a batch */
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

/* The separator of a table's fields, and the end of its lines. */
struct table_marks {
    char separator[2];
    const char *end;
};

static struct table_marks marks_of(const conus_report *report)
{
    static const struct table_marks tsv = {"\t", "\n"};
    static const struct table_marks csv = {",", "\r\n"}; /* RFC 4180, section 2 */
    return report->as == REPORT_CSV ? csv : tsv;
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

static void write_table_text(struct buffer *out, const conus_report *report, const char *text)
{
    if (report->as == REPORT_CSV) {
        write_csv_text(out, text);
    } else {
        buffer_text(out, text);
    }
}

static void write_names(struct buffer *out, const conus_report *report)
{
    const struct table_marks marks = marks_of(report);
    const char *before = "";
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (size_t i = 0; i < columns.count; i++) {
        buffer_text(out, before);
        write_table_text(out, report, columns.at[i]->name);
        before = marks.separator;
    }
    buffer_text(out, marks.end);
}

/* The columns of the table that a row is of; NULL = none. */
static const conus_column *table_of(const conus_report *report, const struct report_row *row)
{
    bool is_of_table = report->fields && !report->queries[row->query].error;
    return is_of_table ? table_columns(row->of_table.table) : NULL;
}

/* The value in a column, of tables without a call. */
static inline struct cell cell_of(const conus_report *report, const struct report_column *column,
                                  const struct report_row *row, const conus_column *table)
{
    return table && column->home == HOME_TABLE ? table_cell(&table[column->offset], row->of_table.index)
                                               : report_cell(report, column, row);
}

static void write_table_row(struct buffer *out, const conus_report *report, const struct report_columns *columns,
                            const struct report_row *row)
{
    const struct table_marks marks = marks_of(report);
    const conus_column *table = table_of(report, row);
    const unsigned there = table ? 0 : report_needs_met(report, row); /* tables have what their columns need */
    for (size_t i = 0; i < columns->count; i++) {
        if (i > 0) {
            buffer_append(out, marks.separator, 1);
        }
        if (columns->at[i]->needs & ~there) {
            buffer_append(out, "n/a", 3);
            continue;
        }
        struct cell cell = cell_of(report, columns->at[i], row, table);
        if (cell.type == CELL_TEXT) {
            write_table_text(out, report, cell.text);
        } else {
            report_write_cell(out, cell);
        }
    }
    buffer_text(out, marks.end);
}

static void write_area(struct buffer *out, const conus_report *report, const struct report_matrix *matrix, size_t area)
{
    const char *name = conus_table_texts(matrix->areas, "name")[area];
    write_table_text(out, report, name ? name : "");
}

void report_write_matrix(struct buffer *out, const conus_report *report, const struct report_matrix *matrix)
{
    const struct table_marks marks = marks_of(report);
    const int64_t *streamlines = conus_table_counts(matrix->pairs, "streamlines");
    const uint32_t *pair = matrix->pair;
    buffer_text(out, "area");
    for (size_t i = 0; i < matrix->count; i++) {
        buffer_text(out, marks.separator);
        write_area(out, report, matrix, i);
    }
    buffer_text(out, marks.end);
    for (size_t i = 0; i < matrix->count; i++) {
        write_area(out, report, matrix, i);
        for (size_t j = 0; j < matrix->count; j++, pair++) {
            buffer_text(out, marks.separator);
            buffer_whole(out, *pair ? (uint64_t)streamlines[*pair - 1] : 0);
        }
        buffer_text(out, marks.end);
    }
}

/* Writes the text, which is UTF-8, as a JSON string. */
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

static void write_json_row(struct buffer *out, const conus_report *report, const struct report_columns *columns,
                           const struct report_row *row)
{
    const char *before = "{";
    const conus_column *table = table_of(report, row);
    for (size_t i = 0; i < columns->count; i++) {
        struct cell cell = cell_of(report, columns->at[i], row, table);
        buffer_append(out, before, 1);
        before = ",";
        write_string(out, columns->at[i]->name);
        buffer_append(out, ":", 1);
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

void report_each_row(const conus_report *report, report_take_row *take, void *user)
{
    for (size_t first = 0, end; first < report->query_count; first = end) {
        end = first + 1; /* in shares the angles of a pose, which have one id, belong together */
        while (report->kind == ROWS_SHARES && end < report->query_count && report_is_same_pose(report, end, first)) {
            end++;
        }
        for (const conus_report *of = report; of && end <= of->query_count; of = of->next) {
            for (size_t i = of->queries[first].first_row; i < report_row_end(of, end - 1); i++) {
                if (report_is_shown(of, i)) {
                    take(user, of, &of->rows[i]);
                }
            }
        }
    }
}

struct writing {
    struct buffer *out;
    struct report_columns columns;
};

static void write_row(void *user, const conus_report *of, const struct report_row *row)
{
    struct writing *writing = user;
    if (of->as == REPORT_NDJSON) {
        write_json_row(writing->out, of, &writing->columns, row);
    } else {
        write_table_row(writing->out, of, &writing->columns, row);
    }
}

static conus_status write_rows(struct buffer *out, const conus_report *report)
{
    struct writing writing = {.out = out};
    report_list_columns(&writing.columns, report);
    report_each_row(report, write_row, &writing);
    return CONUS_OK;
}

const struct report_format report_format_tsv = {.header = write_names, .part = write_rows};
const struct report_format report_format_csv = {.header = write_names, .part = write_rows};
const struct report_format report_format_ndjson = {.part = write_rows};
const struct report_format report_format_bep032 = {.header = write_names, .part = write_rows};
