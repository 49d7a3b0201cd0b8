/* SPDX-License-Identifier: BSD-3-Clause */
/* The BIDS table of electrodes that was asked about, with columns added that say where each contact is. */
#include "base/memory.h"
#include "base/text.h"
#include "poses/programs/pose_programs.h"
#include "selection/report/parts.h"

/* Appends @p count fields of the line: missing ones as n/a, without what is too much. */
static void write_fields(struct buffer *out, struct text line, size_t count)
{
    struct text field = {"", 0};
    bool more = true;
    for (size_t i = 0; i < count; i++) {
        bool found = text_field(&line, '\t', &more, &field);
        buffer_append(out, "\t", i > 0);
        buffer_append(out, found ? field.data : "n/a", found ? field.size : 3);
    }
}

/* The number of fields; 0, with a message, if one is called as a column that is to be added. */
static size_t check_header(const conus_report *report, struct text line)
{
    struct text field;
    size_t count = 0;
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (bool more = true; text_field(&line, '\t', &more, &field); count++) {
        for (size_t i = 0; i < columns.count; i++) {
            if (text_equal(text_trim(field), columns.at[i]->name)) {
                (void)fail(CONUS_ERROR_DATA, "electrodes: there is a column %s already", columns.at[i]->name);
                return 0;
            }
        }
    }
    return count;
}

static void write_cells(struct buffer *out, const conus_report *report, const struct report_row *row)
{
    struct report_columns columns;
    report_list_columns(&columns, report);
    for (size_t i = 0; i < columns.count; i++) {
        buffer_append(out, "\t", 1);
        report_write_cell(out, row ? report_cell(report, columns.at[i], row)
                                   : (struct cell){.type = CELL_TEXT, .text = columns.at[i]->name});
    }
    buffer_append(out, "\n", 1);
}

/* The next line that holds data. */
static bool next_line(struct text *rest, struct text *line)
{
    bool found = false;
    do {
        found = text_line(rest, line);
    } while (found && !text_trim(*line).size);
    return found;
}

static conus_status add_line(conus_report *report, struct text line)
{
    if (!memory_reserve(&report->electrode_lines, &report->electrode_line_capacity, report->electrode_line_count + 1,
                        sizeof line)) {
        return CONUS_ERROR_MEMORY;
    }
    report->electrode_lines[report->electrode_line_count++] = line;
    return CONUS_OK;
}

conus_status report_read_electrodes(conus_report *report)
{
    struct text rest = text_from(report->options.electrodes);
    struct text line;
    if (text_starts(rest, "\xef\xbb\xbf")) {
        rest.data += 3;
        rest.size -= 3;
    }
    if (!next_line(&rest, &line) || !pose_electrodes_header(line, false)) {
        return fail(CONUS_ERROR_DATA, "electrodes: the first line has not the columns name, x, y and z");
    }
    report->electrode_field_count = check_header(report, line);
    conus_status status = report->electrode_field_count ? add_line(report, line) : CONUS_ERROR_DATA;
    while (!status && next_line(&rest, &line)) {
        status = add_line(report, line);
    }
    return status;
}

static void write_header(struct buffer *out, const conus_report *report)
{
    write_fields(out, report->electrode_lines[0], report->electrode_field_count);
    write_cells(out, report, NULL);
}

static conus_status write_electrodes(struct buffer *out, const conus_report *report)
{
    const struct text *lines = report->electrode_lines + 1 + report->taken;
    if (report->taken + report->query_count >= report->electrode_line_count) {
        return fail(CONUS_ERROR_DATA, "electrodes: %zu rows, fewer than answers", report->electrode_line_count - 1);
    }
    for (size_t i = 0; i < report->query_count; i++) {
        write_fields(out, lines[i], report->electrode_field_count);
        write_cells(out, report, &report->rows[report->queries[i].first_row]);
    }
    return CONUS_OK;
}

const struct report_format report_format_bids = {.header = write_header, .part = write_electrodes};
