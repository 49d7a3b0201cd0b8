/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of what regions of interest cover. */
#include "conus/own.h"
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

#include <math.h>
#include <stdio.h>

static void write_coverage(struct buffer *out, const conus_report *report, const struct report_row *row, int width)
{
    char label[TABLE_LABEL_SIZE];
    char volume[TABLE_VOLUME_SIZE];
    char fraction[16] = "";
    int digits = table_digits(report);
    uint32_t object = row->of_table.object;
    double part = report_number(row, "fraction");
    if (isfinite(part)) {
        snprintf(fraction, sizeof fraction, "%.2f", 100 * part);
    }
    table_write_name(out, object ? table_name(report, object) : "(in no area)", width);
    buffer_format(out, "  %10s  %11s  %9s  %9.2f  %10.5g  %8.*f %8.*f %8.*f\n", table_label(label, report, object),
                  table_volume(volume, report_number(row, "volume_mm3")), fraction,
                  100 * report_number(row, "region_fraction"), report_number(row, "peak"), digits,
                  report_number(row, "peak_x"), digits, report_number(row, "peak_y"), digits,
                  report_number(row, "peak_z"));
}

void table_write_region(struct buffer *out, const struct report_query *query)
{
    char threshold[TEXT_NUMBER_SIZE];
    char volume[TABLE_VOLUME_SIZE];
    const struct table_region *roi = &query->asked.region;
    buffer_format(out, "region %s: ", query->id);
    if (roi->threshold == 0) {
        buffer_text(out, "mask");
    } else {
        buffer_format(out, "values of %s and %s", text_number(threshold, roi->threshold),
                      roi->threshold > 0 ? "more" : "less");
    }
    buffer_format(out, ", %s mm^3\n", table_volume(volume, roi->volume_mm3));
}

void report_write_overlap(struct buffer *out, const conus_report *report)
{
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count; i++) {
        table_write_region(out, &report->queries[i]);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            table_write_atlas(out, of);
            char axes[TABLE_AXES_SIZE];
            static const char form[] = "%-*s  %10s  %11s  %9s  %9s  %10s  %26s\n";
            buffer_format(out, form, width, "name", "label", "volume", "of area", "of region", "peak",
                          table_axes(axes, of, "at"));
            buffer_format(out, form, width, "", "", "mm^3", "%", "%", "", conus_space_unit(of->frame.space));
            for (size_t k = of->queries[i].first_row; k < of->row_count && of->rows[k].query == i; k++) {
                write_coverage(out, of, &of->rows[k], width);
            }
        }
        buffer_text(out, i + 1 < report->query_count ? "\n" : "");
    }
    table_write_sources(out, report);
}
