/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of which areas bundles connect. */
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

static const char NO_AREA[] = "(in no area)";

/* The end in this column; its label is n/a where it is in no area. */
static const char *end_name(const struct report_row *row, const char *end, const char *label)
{
    const conus_column *index = conus_table_find(row->of_table.table, label);
    bool is_none = index->missing && index->missing[row->of_table.index];
    return is_none ? NO_AREA : report_text(row, end);
}

static const char *name_of_a(const struct report_row *row)
{
    return end_name(row, "end_a", "end_a_index");
}

static const char *name_of_b(const struct report_row *row)
{
    return end_name(row, "end_b", "end_b_index");
}

/* Columns for the longest name of a bundle, and of an area. */
struct widths {
    int bundle, end;
};

static struct widths find_widths(const conus_report *report)
{
    struct widths widths = {.bundle = 6, .end = 12};
    for (; report; report = report->next) {
        for (size_t i = 0; i < report->row_count; i++) {
            const struct report_row *row = &report->rows[i];
            if (row->of_table.table) { /* no error */
                widths.bundle = table_wider(widths.bundle, report_text(row, "bundle"));
                widths.end = table_wider(widths.end, name_of_a(row));
                widths.end = table_wider(widths.end, name_of_b(row));
            }
        }
    }
    return widths;
}

/* The answers of one atlas. */
static void write_answers(struct buffer *out, const conus_report *report, size_t query, struct widths widths)
{
    size_t first = report->queries[query].first_row;
    size_t end = report_row_end(report, query);
    table_write_atlas(out, report);
    if (first == end) {
        buffer_text(out, "(no streamline)\n");
        return;
    }
    static const char form[] = "%-*s  %-*s  %-*s  %11s  %9s  %11s\n";
    buffer_format(out, form, widths.bundle, "bundle", widths.end, "end", widths.end, "other end", "streamlines",
                  "of bundle", "mean length");
    buffer_format(out, form, widths.bundle, "", widths.end, "", widths.end, "", "", "%", "mm");
    for (size_t i = first; i < end; i++) {
        const struct report_row *row = &report->rows[i];
        table_write_name(out, report_text(row, "bundle"), widths.bundle);
        buffer_text(out, "  ");
        table_write_name(out, name_of_a(row), widths.end);
        buffer_text(out, "  ");
        table_write_name(out, name_of_b(row), widths.end);
        buffer_format(out, "  %11lld  %9.2f  %11.1f\n",
                      (long long)conus_table_counts(row->of_table.table, "streamlines")[row->of_table.index],
                      100 * report_number(row, "fraction"), report_number(row, "mean_length_mm"));
    }
}

void report_write_connections(struct buffer *out, const conus_report *report)
{
    struct widths widths = find_widths(report);
    for (size_t i = 0; i < report->query_count; i++) {
        bool more = i + 1 < report->query_count;
        if (report->queries[i].error) {
            table_write_error(out, report, &report->queries[i], more);
            continue;
        }
        const struct report_query *query = &report->queries[i];
        if (query->asked.is_whole) {
            buffer_text(out, "all streamlines\n");
        } else {
            table_write_query(out, report, query);
        }
        if (query->asked.end_radius > 0) {
            buffer_format(out, "ends in an area, or in the nearest one within %.4g mm\n", query->asked.end_radius);
        } else {
            buffer_text(out, "ends in an area\n");
        }
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answers(out, of, i, widths);
        }
        buffer_text(out, more ? "\n" : "");
    }
    table_write_sources(out, report);
}
