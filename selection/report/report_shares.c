/* SPDX-License-Identifier: BSD-3-Clause */
/* The table for people of shares at several angles. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <stdio.h>

enum { ANGLES_IN_A_TABLE = 10 };

/* Queries first to end - 1: one pose, several angles. */
struct block {
    size_t first, end;
};

static struct block block_at(const conus_report *report, size_t first)
{
    struct block block = {first, first + 1};
    while (block.end < report->query_count && !report->queries[block.end].error &&
           block.end - first < ANGLES_IN_A_TABLE && report_is_same_pose(report, block.end, first)) {
        block.end++;
    }
    return block;
}

/* An object's results at the block's angles; NULL where there is none. */
struct line {
    const conus_result *at[ANGLES_IN_A_TABLE];
};

struct shares {
    struct block block;
    struct line *lines; /* [object_count + 1] */
};

static void write_shares_row(struct buffer *out, const conus_report *report, const struct shares *shares,
                             const struct report_row *row, int width)
{
    char label[TABLE_LABEL_SIZE];
    const struct line *line = &shares->lines[row->result.object];
    table_write_name(out, table_name(report, row->result.object), width);
    buffer_format(out, "  %10s", table_label(label, report, row->result.object));
    for (size_t i = 0; i < shares->block.end - shares->block.first; i++) {
        if (line->at[i]) {
            char share[TEXT_SHARE_SIZE];
            buffer_format(out, "  %6s", text_share(share, line->at[i]->share, report_share_digits(report)));
        } else {
            buffer_format(out, "  %6s", "");
        }
    }
    buffer_text(out, "\n");
}

/* Objects that the angle of query `query` brings, or what hit nothing. */
static void write_new_rows(struct buffer *out, const conus_report *report, const struct shares *shares, size_t query,
                           bool nothing, int width)
{
    for (size_t r = report->queries[query].first_row; r < report_row_end(report, query); r++) {
        const struct report_row *row = &report->rows[r];
        const struct line *line = &shares->lines[row->result.object];
        size_t first = 0;
        while (!line->at[first]) {
            first++;
        }
        if (first == query - shares->block.first && nothing == (row->result.object == 0)) {
            write_shares_row(out, report, shares, row, width);
        }
    }
}

/* Objects in the order in which the angles bring them, what hit nothing last. */
static void write_shares(struct buffer *out, const conus_report *report, struct block block, int width)
{
    struct shares shares = {block, memory_zeroed(report->atlas->object_count + 1, sizeof *shares.lines)};
    if (!shares.lines) {
        out->failed = true;
        return;
    }
    for (size_t i = shares.block.first; i < shares.block.end; i++) {
        for (size_t r = report->queries[i].first_row; r < report_row_end(report, i); r++) {
            const conus_result *result = &report->rows[r].result;
            shares.lines[result->object].at[i - shares.block.first] = result;
        }
    }
    buffer_format(out, "%-*s  %10s  share of cone in %% at an angle of ... degrees\n%-*s  %10s", width, "name", "label",
                  width, "", "");
    for (size_t i = block.first; i < block.end; i++) {
        buffer_format(out, "  %6.4g", report->queries[i].asked.cone.degrees);
    }
    buffer_text(out, "\n");
    for (size_t i = block.first; i < block.end; i++) {
        write_new_rows(out, report, &shares, i, false, width);
    }
    write_new_rows(out, report, &shares, block.first, true, width);
    memory_free(shares.lines);
}

void report_write_shares(struct buffer *out, const conus_report *report)
{
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count;) {
        if (report->queries[i].error) {
            table_write_error(out, report, &report->queries[i], i + 1 < report->query_count);
            i++;
            continue;
        }
        const struct block block = block_at(report, i);
        table_write_query(out, report, &report->queries[i]);
        for (const conus_report *of = report; of && block.end <= of->query_count; of = of->next) {
            table_write_atlas(out, of);
            write_shares(out, of, block, width);
        }
        i = block.end;
        buffer_text(out, i < report->query_count ? "\n" : "");
    }
    table_write_sources(out, report);
}
