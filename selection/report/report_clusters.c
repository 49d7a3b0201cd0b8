/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of the clusters of regions of interest. */
#include "selection/report/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

static bool is_of_kind(const struct report_row *row, const char *kind)
{
    return strcmp(conus_table_texts(row->of_table.table, "kind")[row->of_table.index], kind) == 0;
}

static unsigned long long count_of(const struct report_row *row, const char *column)
{
    return (unsigned long long)conus_table_counts(row->of_table.table, column)[row->of_table.index];
}

static void write_place(struct buffer *out, const conus_report *report, const struct report_row *row,
                        const char *const columns[3])
{
    int digits = table_digits(report);
    buffer_format(out, " %.*f, %.*f, %.*f", digits, report_number(row, columns[0]), digits,
                  report_number(row, columns[1]), digits, report_number(row, columns[2]));
}

static const char *const peak[] = {"peak_x", "peak_y", "peak_z"};

static void write_whole(struct buffer *out, const conus_report *report, const struct report_row *row)
{
    static const char *const centre[] = {"centre_x", "centre_y", "centre_z"};
    char volume[TABLE_VOLUME_SIZE];
    unsigned long long voxels = count_of(row, "voxels");
    buffer_format(out, "cluster %llu: %llu voxel%s, %s mm^3, peak %.5g at", count_of(row, "cluster"), voxels,
                  voxels > 1 ? "s" : "", table_volume(volume, report_number(row, "volume_mm3")),
                  report_number(row, "peak"));
    write_place(out, report, row, peak);
    buffer_text(out, ", centre of mass");
    write_place(out, report, row, centre);
    table_write_space(out, report);
}

static const struct shown parts_shown[] = {
    {"name", "", LOOK_NAME, .none = "(in no area)"},
    {"volume, mm^3", "", LOOK_VOLUME, .width = 11, .column = "volume_mm3"},
    {"of area, %", "", LOOK_PERCENT, .width = 9, .column = "fraction", .digits = 2},
    {"cluster, %", "", LOOK_PERCENT, .width = 10, .column = "cluster_fraction", .digits = 2},
    {"peak", "", LOOK_SHORT, .width = 10, .column = "peak", .digits = 5},
    {"at", NULL, LOOK_PLACE, .column = "peak_"},
    {0},
};

static void write_answers(struct buffer *out, const conus_report *report, size_t query, const struct layout *parts)
{
    table_write_atlas(out, report);
    for (size_t i = report->queries[query].first_row; i < report_row_end(report, query); i++) {
        const struct report_row *row = &report->rows[i];
        if (is_of_kind(row, "cluster")) {
            write_whole(out, report, row);
            buffer_text(out, "           ");
            table_write_heading(out, report, parts, false);
        } else {
            buffer_text(out, is_of_kind(row, "maximum") ? "  maximum  " : "           ");
            table_write_row(out, report, parts, row);
            buffer_text(out, "\n");
        }
    }
}

void report_write_clusters(struct buffer *out, const conus_report *report)
{
    const struct layout parts = table_lay_out(report, parts_shown);
    for (size_t i = 0; i < report->query_count; i++) {
        table_write_region(out, &report->queries[i]);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answers(out, of, i, &parts);
        }
        buffer_text(out, i + 1 < report->query_count ? "\n" : "");
    }
    table_write_sources(out, report);
}
