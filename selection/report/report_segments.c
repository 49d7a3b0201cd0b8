/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of what axes pass. */
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

#include <math.h>
#include <string.h>

static const char NO_OBJECT[] = "(in no area)";

/* Nothing of a depth that there is not. */
static void write_depth(struct buffer *out, double depth)
{
    if (isfinite(depth)) {
        buffer_format(out, "  %8.2f", depth);
    } else {
        buffer_format(out, "  %8s", "-");
    }
}

void report_write_segments(struct buffer *out, const conus_report *report)
{
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count; i++) {
        bool more = i + 1 < report->query_count;
        if (report->queries[i].error) {
            table_write_error(out, &report->queries[i], more);
            continue;
        }
        const struct report_query *query = &report->queries[i];
        if (report->query_count > 1) {
            buffer_format(out, "query %s: ", query->id);
        }
        buffer_text(out, "axis");
        table_write_axis(out, report, query);
        if (cone_has_range(&query->cone)) {
            buffer_format(out, ", %.4g to %.4g mm deep", query->cone.range[0], query->cone.range[1]);
        }
        table_write_space(out, report);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            size_t first = of->queries[i].first_row;
            table_write_atlas(out, of);
            static const char form[] = "%5s  %-*s  %10s  %8s  %8s  %8s  %24s\n";
            char axes[TABLE_AXES_SIZE];
            buffer_format(out, form, "order", width, "name", "label", "enters", "leaves", "length",
                          table_axes(axes, of, "enters at"));
            buffer_format(out, form, "", width, "", "", "mm", "mm", "mm", conus_space_unit(of->frame.space));
            for (size_t k = first; k < report_row_end(of, i); k++) {
                const conus_segment *segment = &of->rows[k].segment;
                char label[TABLE_LABEL_SIZE];
                double at[3];
                memcpy(at, segment->entry_at, sizeof at);
                report_point(of, at);
                buffer_format(out, "%5zu  ", k - first + 1);
                table_write_name(out, segment->object ? table_name(of, segment->object) : NO_OBJECT, width);
                buffer_format(out, "  %10s", table_label(label, of, segment->object));
                write_depth(out, segment->entry);
                write_depth(out, segment->exit);
                write_depth(out, segment->exit - segment->entry);
                int digits = table_digits(of);
                buffer_format(out, "  %8.*f %7.*f %7.*f\n", digits, at[0], digits, at[1], digits, at[2]);
            }
        }
        buffer_text(out, more ? "\n" : "");
    }
    table_write_sources(out, report);
}
