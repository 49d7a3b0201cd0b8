/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of a track for people: a line per object and step, under one header. */
#include "base/geometry/math3.h"
#include "base/text.h"
#include "selection/report/parts.h"

#include <stdio.h>
#include <string.h>

enum { NAME_LIMIT = 32 };

struct widths {
    int name;
    int atlas; /* 0 = there is no such column */
};

static int wider(int width, const char *text)
{
    size_t wanted = strlen(text);
    return wanted > NAME_LIMIT ? NAME_LIMIT : (int)wanted > width ? (int)wanted : width;
}

/* Rows come without end, so the width is that of the longest name there could be. */
static struct widths widths_of(const conus_report *report)
{
    struct widths widths = {.name = wider(0, TABLE_NOTHING), .atlas = report->name ? wider(0, "atlas") : 0};
    for (; report; report = report->next) {
        for (size_t i = 1; i <= conus_atlas_object_count(report->atlas); i++) {
            widths.name = wider(widths.name, conus_atlas_object(report->atlas, i)->name);
        }
        widths.atlas = report->name ? wider(widths.atlas, report->name) : 0;
    }
    return widths;
}

/* A cell of the column `atlas`, where there is one. */
static void write_atlas(struct buffer *out, const char *text, int width)
{
    if (width) {
        table_write_name(out, text, width);
        buffer_text(out, "  ");
    }
}

struct writing {
    struct buffer *out;
    struct widths widths;
};

static void write_row(void *user, const conus_report *report, const struct report_row *row)
{
    const struct writing *writing = user;
    struct buffer *out = writing->out;
    const conus_object *object = conus_atlas_object(report->atlas, row->result.object);
    if (!object && !row->result.pixels) {
        return;
    }
    char rank[16] = "";
    if (object) {
        snprintf(rank, sizeof rank, "%u", row->result.rank);
    }
    buffer_format(out, "%10.3f  ", report->queries[row->query].step.time_s);
    write_atlas(out, report->name, writing->widths.atlas);
    buffer_format(out, "%4s  ", rank);
    table_write_name(out, table_name(report, row->result.object), writing->widths.name);
    char score[TEXT_NUMBER_SIZE] = "";
    char label[16] = "";
    char share[TEXT_SHARE_SIZE];
    if (object) {
        snprintf(score, sizeof score, "%.4g", row->result.score);
        snprintf(label, sizeof label, "%u", object->label);
    }
    buffer_format(out, "  %10s  %10s  %6s %%  %6u", label, isfinite(row->result.score) ? score : "",
                  text_share(share, row->result.share, report_share_digits(report)), row->result.pixels);
    if (isfinite(row->result.offset)) {
        buffer_format(out, "  %8.2f", row->result.offset);
    } else if (object) {
        buffer_format(out, "  %8s", "");
    }
    buffer_text(out, report_is_selected(report, row) ? "  selected" : "");
    buffer_text(out, report_is_confirmed(report, row) ? "  confirmed" : "");
    buffer_text(out, "\n");
}

void report_write_track(struct buffer *out, const conus_report *report)
{
    struct writing writing = {out, widths_of(report)};
    if (!report->is_begun) {
        struct widths widths = writing.widths;
        buffer_format(out, "ranked by %s; engine %s\n%10s  ", report->score, report->engine, "time");
        write_atlas(out, "atlas", widths.atlas);
        buffer_format(out, "%4s  %-*s  %10s  %10s  %8s  %6s  %8s\n%10s  ", "rank", widths.name, "name", "label",
                      "score", "share", "pixels", "off axis", "s");
        write_atlas(out, "", widths.atlas);
        buffer_format(out, "%4s  %-*s  %10s  %10s  %8s  %6s  %8s\n", "", widths.name, "", "", "", "of cone", "",
                      "degrees");
    }
    report_each_row(report, write_row, &writing);
}
