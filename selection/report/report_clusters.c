/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of the clusters of regions of interest. */
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void write_place(struct buffer *out, const conus_report *report, const double place[3])
{
    int digits = table_digits(report);
    double at[3];
    memcpy(at, place, sizeof at);
    report_point(report, at);
    buffer_format(out, " %.*f, %.*f, %.*f", digits, at[0], digits, at[1], digits, at[2]);
}

static void write_whole(struct buffer *out, const conus_report *report, const conus_cluster_row *row)
{
    char volume[TABLE_VOLUME_SIZE];
    buffer_format(out, "cluster %u: %llu voxel%s, %s mm^3, peak %.5g at", row->cluster, (unsigned long long)row->voxels,
                  row->voxels > 1 ? "s" : "", table_volume(volume, row->volume), row->peak);
    write_place(out, report, row->peak_point);
    buffer_text(out, ", centre of mass");
    write_place(out, report, row->centre);
    table_write_space(out, report);
}

static void write_part(struct buffer *out, const conus_report *report, const conus_cluster_row *row, int width)
{
    char volume[TABLE_VOLUME_SIZE] = "";
    char fraction[16] = "";
    char of_cluster[16] = "";
    bool is_maximum = row->part == CONUS_CLUSTER_MAXIMUM;
    if (isfinite(row->fraction)) {
        snprintf(fraction, sizeof fraction, "%.2f", 100 * row->fraction);
    }
    if (!is_maximum) {
        snprintf(of_cluster, sizeof of_cluster, "%.2f", 100 * row->cluster_fraction);
        table_volume(volume, row->volume);
    }
    buffer_text(out, is_maximum ? "  maximum  " : "           ");
    table_write_name(out, row->object ? table_name(report, row->object) : "(in no area)", width);
    buffer_format(out, "  %11s  %9s  %10s  %10.5g ", volume, fraction, of_cluster, row->peak);
    write_place(out, report, row->peak_point);
    buffer_text(out, "\n");
}

static void write_answers(struct buffer *out, const conus_report *report, size_t query, int width)
{
    char axes[TABLE_AXES_SIZE];
    table_write_atlas(out, report);
    for (size_t i = report->queries[query].first_row; i < report_row_end(report, query); i++) {
        const conus_cluster_row *row = &report->rows[i].cluster;
        if (row->part == CONUS_CLUSTER_WHOLE) {
            write_whole(out, report, row);
            buffer_format(out, "           %-*s  %11s  %9s  %10s  %10s  %s\n", width, "name", "volume, mm^3",
                          "of area, %", "cluster, %", "peak", table_axes(axes, report, "at"));
        } else {
            write_part(out, report, row, width);
        }
    }
}

void report_write_clusters(struct buffer *out, const conus_report *report)
{
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count; i++) {
        table_write_region(out, &report->queries[i]);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answers(out, of, i, width);
        }
        buffer_text(out, i + 1 < report->query_count ? "\n" : "");
    }
    table_write_sources(out, report);
}
