/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables for people of what axes pass, and of how far needles stay from objects. */
#include "conus/own.h"
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

#include <math.h>
#include <stdio.h>

static const char NO_OBJECT[] = "(in no area)";

/* Writes nothing for a depth that is not known. */
static void write_depth(struct buffer *out, double depth)
{
    if (isfinite(depth)) {
        buffer_format(out, "  %8.2f", depth);
    } else {
        buffer_format(out, "  %8s", "-");
    }
}

/* Writes the point in three columns. */
static void write_place(struct buffer *out, const conus_report *report, const struct report_row *row,
                        const char *const columns[3])
{
    int digits = table_digits(report);
    buffer_format(out, "  %8.*f %7.*f %7.*f", digits, report_number(row, columns[0]), digits,
                  report_number(row, columns[1]), digits, report_number(row, columns[2]));
}

/* Writes the rows of a query from one atlas, with their heading. */
typedef void rows_writer(struct buffer *out, const conus_report *report, size_t query, int width);

static void write_segments(struct buffer *out, const conus_report *report, size_t query, int width)
{
    static const char form[] = "%5s  %-*s  %10s  %8s  %8s  %8s  %24s\n";
    char axes[TABLE_AXES_SIZE];
    size_t first = report->queries[query].first_row;
    buffer_format(out, form, "order", width, "name", "label", "enters", "leaves", "length",
                  table_axes(axes, report, "enters at"));
    buffer_format(out, form, "", width, "", "", "mm", "mm", "mm", conus_space_unit(report->frame.space));
    for (size_t i = first; i < report_row_end(report, query); i++) {
        const struct report_row *row = &report->rows[i];
        uint32_t object = row->of_table.object;
        char label[TABLE_LABEL_SIZE];
        buffer_format(out, "%5zu  ", i - first + 1);
        table_write_name(out, object ? table_name(report, object) : NO_OBJECT, width);
        buffer_format(out, "  %10s", table_label(label, report, object));
        write_depth(out, report_number(row, "entry_mm"));
        write_depth(out, report_number(row, "exit_mm"));
        write_depth(out, report_number(row, "length_mm"));
        write_place(out, report, row, (const char *const[]){"entry_x", "entry_y", "entry_z"});
        buffer_text(out, "\n");
    }
}

static void write_clearances(struct buffer *out, const conus_report *report, size_t query, int width)
{
    static const char form[] = "%-*s  %10s  %9s  %8s  %8s  %24s  %24s\n";
    char at[TABLE_AXES_SIZE];
    char near[TABLE_AXES_SIZE];
    const char *unit = conus_space_unit(report->frame.space);
    size_t first = report->queries[query].first_row;
    size_t end = report_row_end(report, query);
    if (first == end) {
        buffer_text(out, "no area, pathway or bundle is that near\n");
        return;
    }
    buffer_format(out, form, width, "name", "label", "clearance", "distance", "depth",
                  table_axes(at, report, "axis at"), table_axes(near, report, "object at"));
    buffer_format(out, form, width, "", "", "mm", "mm", "mm", unit, unit);
    for (size_t i = first; i < end; i++) {
        const struct report_row *row = &report->rows[i];
        double clearance = report_number(row, "clearance_mm");
        double distance = report_number(row, "distance_mm");
        char label[TABLE_LABEL_SIZE];
        table_write_name(out, table_name(report, row->of_table.object), width);
        buffer_format(out, "  %10s", table_label(label, report, row->of_table.object));
        if (clearance > 0) {
            buffer_format(out, "  %9.2f", clearance);
        } else {
            buffer_format(out, "  %9s", distance > 0 ? "touches" : "pierces");
        }
        write_depth(out, distance);
        write_depth(out, report_number(row, "depth_mm"));
        write_place(out, report, row, (const char *const[]){"x", "y", "z"});
        write_place(out, report, row, (const char *const[]){"near_x", "near_y", "near_z"});
        buffer_text(out, "\n");
    }
}

static void write_each_axis(struct buffer *out, const conus_report *report, const char *what, const char *endless,
                            rows_writer *write_rows)
{
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        bool more = i + 1 < report->query_count;
        if (query->error) {
            table_write_error(out, report, query, more);
            continue;
        }
        if (report->query_count > 1) {
            table_write_id(out, report, query);
        }
        buffer_text(out, what);
        table_write_axis(out, report, query);
        if (cone_has_range(&query->asked.cone)) {
            buffer_format(out, ", %.4g to %.4g mm deep", query->asked.cone.range[0], query->asked.cone.range[1]);
        } else {
            buffer_text(out, endless);
        }
        table_write_space(out, report);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            table_write_atlas(out, of);
            write_rows(out, of, i, width);
        }
        buffer_text(out, more ? "\n" : "");
    }
}

void report_write_segments(struct buffer *out, const conus_report *report)
{
    write_each_axis(out, report, "axis", "", write_segments);
    table_write_sources(out, report);
}

void report_write_clearances(struct buffer *out, const conus_report *report)
{
    char what[64] = "axis";
    if (report->selector.radius > 0) {
        snprintf(what, sizeof what, "needle of radius %.4g mm", report->selector.radius);
    }
    write_each_axis(out, report, what, ", without an end", write_clearances);
    if (isfinite(report->options.within)) {
        buffer_format(out, "up to %.4g mm away, ", report->options.within);
    }
    buffer_text(out, report->selector.radius > 0
                         ? "the nearest first; clearance is the distance of the axis less the radius\n"
                         : "the nearest first; without a radius the clearance is the distance of the axis\n");
    table_write_sources(out, report);
}
