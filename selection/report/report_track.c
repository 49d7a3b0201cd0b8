/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of a track for people: a line per object and step, under one header. */
#include "base/math3.h"
#include "base/text.h"
#include "selection/report/report_table.h"
#include "selection/report/report_writers.h"

#include <stdio.h>
#include <string.h>

enum { NAME_LIMIT = 32 };

/* Rows come without end, so the width is that of the longest name there could be. */
static int name_width(const conus_report *report)
{
    size_t width = strlen(TABLE_NOTHING);
    for (size_t i = 1; i <= conus_atlas_object_count(report->atlas); i++) {
        size_t wanted = strlen(conus_atlas_object(report->atlas, i)->name);
        width = wanted > width ? wanted : width;
    }
    return width < NAME_LIMIT ? (int)width : NAME_LIMIT;
}

static void write_header(struct buffer *out, const conus_report *report, int width)
{
    buffer_format(out, "ranked by %s; engine %s\n", report->score, report->engine);
    buffer_format(out, "%10s  %4s  %-*s  %10s  %10s  %8s  %6s  %8s\n", "time", "rank", width, "name", "label", "score",
                  "share", "pixels", "off axis");
    buffer_format(out, "%10s  %4s  %-*s  %10s  %10s  %8s  %6s  %8s\n", "s", "", width, "", "", "", "of cone", "",
                  "degrees");
}

static void write_numbers(struct buffer *out, const conus_result *result, const conus_object *object)
{
    char score[TEXT_NUMBER_SIZE] = "";
    char label[16] = "";
    if (object) {
        snprintf(score, sizeof score, "%.4g", result->score);
        snprintf(label, sizeof label, "%u", object->label);
    }
    buffer_format(out, "  %10s  %10s  %6.2f %%  %6u", label, isfinite(result->score) ? score : "", 100 * result->share,
                  result->pixels);
    if (isfinite(result->offset)) {
        buffer_format(out, "  %8.2f", degrees_from_radians(result->offset));
    } else if (object) {
        buffer_format(out, "  %8s", "");
    }
}

static void write_row(struct buffer *out, const conus_report *report, const struct report_row *row, int width)
{
    const conus_object *object = conus_atlas_object(report->atlas, row->result.object);
    if (!object && !row->result.pixels) {
        return;
    }
    char rank[16] = "";
    if (object) {
        snprintf(rank, sizeof rank, "%u", row->result.rank);
    }
    buffer_format(out, "%10.3f  %4s  ", report->queries[row->query].step.time_s, rank);
    table_write_name(out, table_name(report, row->result.object), width);
    write_numbers(out, &row->result, object);
    buffer_text(out, report_is_selected(report, row) ? "  selected" : "");
    buffer_text(out, report_is_confirmed(report, row) ? "  confirmed" : "");
    buffer_text(out, "\n");
}

void report_write_track(struct buffer *out, const conus_report *report)
{
    int width = name_width(report);
    if (!report->is_begun) {
        write_header(out, report, width);
    }
    for (size_t i = 0; i < report->row_count; i++) {
        write_row(out, report, &report->rows[i], width);
    }
}
