/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables for people of studies: one writer, and lists of what it shows of each. */
#include "base/geometry/math3.h"
#include "selection/report/parts.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is shown of a study. */
struct view {
    const struct shown *columns; /* up to the one without a title */
    const char *empty;           /* in place of a table without rows; NULL = its heading */
    void (*head)(struct buffer *out, const conus_report *report, const struct report_query *query);
    void (*foot)(struct buffer *out, const conus_report *report, const struct report_query *query); /* or NULL */
    void (*end)(struct buffer *out, const conus_report *report); /* below all tables, or NULL */
};

static const char NO_AREA[] = "(in no area)";

/* Where the axis is, and how deep it goes. */
static void write_axis(struct buffer *out, const conus_report *report, const struct report_query *query,
                       const char *endless)
{
    table_write_axis(out, report, query);
    if (cone_has_range(&query->asked.cone)) {
        buffer_format(out, ", %.4g to %.4g mm deep", query->asked.cone.range[0], query->asked.cone.range[1]);
    } else {
        buffer_text(out, endless);
    }
    table_write_space(out, report);
}

static void write_axis_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    if (report->query_count > 1) {
        table_write_id(out, report, query);
    }
    buffer_text(out, "axis");
    write_axis(out, report, query, "");
}

static void write_needle_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    if (report->query_count > 1) {
        table_write_id(out, report, query);
    }
    if (report->selector.radius > 0) {
        buffer_format(out, "needle of radius %.4g mm", report->selector.radius);
    } else {
        buffer_text(out, "axis");
    }
    write_axis(out, report, query, ", without an end");
}

static void write_needle_end(struct buffer *out, const conus_report *report)
{
    if (isfinite(report->options.within)) {
        buffer_format(out, "up to %.4g mm away, ", report->options.within);
    }
    buffer_text(out, report->selector.radius > 0
                         ? "the nearest first; clearance is the distance of the axis less the radius\n"
                         : "the nearest first; without a radius the clearance is the distance of the axis\n");
}

static void write_chances_foot(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    buffer_format(out,
                  "%u poses with errors of %.4g degrees about each axis and %.4g mm along each (standard deviations); "
                  "ranked by %s; engine %s\n",
                  query->asked.jitter.samples, query->asked.jitter.tilt, query->asked.jitter.shift, report->score,
                  report->engine);
}

static void write_region_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    (void)report;
    table_write_region(out, query);
}

static void write_ends_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    if (query->asked.is_whole) {
        buffer_text(out, "all streamlines\n");
    } else {
        table_write_query(out, report, query);
    }
    buffer_text(out, "ends in an area");
    if (query->asked.end_radius > 0) {
        buffer_format(out, ", or in the nearest one within %.4g mm", query->asked.end_radius);
    }
    buffer_text(out, "\n");
}

static const struct shown segments_shown[] = {
    {"order", "", LOOK_COUNT, .width = 5, .column = "order"},
    {"name", "", LOOK_NAME, .none = NO_AREA},
    {"label", "", LOOK_LABEL, .width = 10},
    {"enters", "mm", LOOK_FIXED, .width = 8, .column = "entry_mm", .digits = 2, .none = "-"},
    {"leaves", "mm", LOOK_FIXED, .width = 8, .column = "exit_mm", .digits = 2, .none = "-"},
    {"length", "mm", LOOK_FIXED, .width = 8, .column = "length_mm", .digits = 2, .none = "-"},
    {"enters at", NULL, LOOK_POINT, .width = 24, .column = "entry_"},
    {0},
};

static const struct shown clearances_shown[] = {
    {"name", "", LOOK_NAME, .none = TABLE_NOTHING},
    {"label", "", LOOK_LABEL, .width = 10},
    {"clearance", "mm", LOOK_STRIKES, .width = 9, .column = "clearance_mm", .digits = 2, .beside = "distance_mm"},
    {"distance", "mm", LOOK_FIXED, .width = 8, .column = "distance_mm", .digits = 2, .none = "-"},
    {"depth", "mm", LOOK_FIXED, .width = 8, .column = "depth_mm", .digits = 2, .none = "-"},
    {"axis at", NULL, LOOK_POINT, .width = 24, .column = ""},
    {"object at", NULL, LOOK_POINT, .width = 24, .column = "near_"},
    {0},
};

static const struct shown admissions_shown[] = {
    {"angle", "degrees", LOOK_FIXED, .width = 9, .column = "angle_deg", .digits = 3},
    {"margin", "degrees", LOOK_FIXED, .width = 9, .column = "margin_deg", .digits = 3},
    {"name", "", LOOK_NAME, .none = TABLE_NOTHING},
    {"label", "", LOOK_LABEL, .width = 10},
    {"distance", "mm", LOOK_FIXED, .width = 9, .column = "distance_mm", .digits = 2},
    {"first reached at", NULL, LOOK_POINT, .width = 26, .column = ""},
    {0},
};

static const struct shown chances_shown[] = {
    {"rank", "", LOOK_COUNT, .width = 4, .column = "rank"},
    {"name", "", LOOK_NAME, .none = TABLE_NOTHING},
    {"label", "", LOOK_LABEL, .width = 10},
    {"hit", "", LOOK_PERCENT, .width = 8, .column = "p_hit", .digits = 2, .after = " %"},
    {"error", "of hit", LOOK_PERCENT, .width = 8, .column = "p_hit_error", .digits = 2, .after = " %"},
    {"seen", "", LOOK_PERCENT, .width = 8, .column = "p_seen", .digits = 2, .after = " %"},
    {"in cone", "", LOOK_PERCENT, .width = 8, .column = "p_in_cone", .digits = 2, .after = " %", .with = WITH_LAYERS},
    {"share", "mean", LOOK_SHARE, .width = 8, .column = "mean_share", .after = " %"},
    {"varies", "by", LOOK_SHARE, .width = 8, .column = "sd_share", .after = " %"},
    {0},
};

static const struct shown coverages_shown[] = {
    {"name", "", LOOK_NAME, .none = NO_AREA},
    {"label", "", LOOK_LABEL, .width = 10},
    {"volume", "mm^3", LOOK_VOLUME, .width = 11, .column = "volume_mm3"},
    {"of area", "%", LOOK_PERCENT, .width = 9, .column = "fraction", .digits = 2},
    {"of region", "%", LOOK_PERCENT, .width = 9, .column = "region_fraction", .digits = 2},
    {"peak", "", LOOK_SHORT, .width = 10, .column = "peak", .digits = 5},
    {"at", NULL, LOOK_POINT, .width = 26, .column = "peak_"},
    {0},
};

static const struct shown connections_shown[] = {
    {"bundle", "", LOOK_TEXT, .width = 6, .column = "bundle"},
    {"end", "", LOOK_TEXT, .width = 12, .column = "end_a", .none = NO_AREA, .beside = "end_a_index"},
    {"other end", "", LOOK_TEXT, .width = 12, .column = "end_b", .none = NO_AREA, .beside = "end_b_index"},
    {"streamlines", "", LOOK_COUNT, .width = 11, .column = "streamlines"},
    {"of bundle", "%", LOOK_PERCENT, .width = 9, .column = "fraction", .digits = 2},
    {"mean length", "mm", LOOK_FIXED, .width = 11, .column = "mean_length_mm", .digits = 1},
    {0},
};

static const struct shown calibration_shown[] = {
    {"parameter", "", LOOK_TEXT, .width = 9, .column = "parameter"},
    {"value", "", LOOK_SHORT, .width = 10, .column = "value", .digits = 5},
    {"low", "95 %", LOOK_SHORT, .width = 10, .column = "low", .digits = 5},
    {"high", "95 %", LOOK_SHORT, .width = 10, .column = "high", .digits = 5},
    {"p", "", LOOK_SHORT, .width = 10, .column = "p", .digits = 5},
    {0},
};

static const struct shown reliability_shown[] = {
    {"trials", "", LOOK_TEXT, .width = 6, .column = "kind"},
    {"from", "%", LOOK_PERCENT, .width = 5, .column = "low", .digits = 0},
    {"to", "%", LOOK_PERCENT, .width = 5, .column = "high", .digits = 0},
    {"number", "", LOOK_COUNT, .width = 8, .column = "n"},
    {"said", "%", LOOK_PERCENT, .width = 7, .column = "said", .digits = 1, .none = "-"},
    {"right", "%", LOOK_PERCENT, .width = 7, .column = "right", .digits = 1, .none = "-"},
    {"low", "95 %", LOOK_PERCENT, .width = 7, .column = "right_low", .digits = 1, .none = "-"},
    {"high", "95 %", LOOK_PERCENT, .width = 7, .column = "right_high", .digits = 1, .none = "-"},
    {0},
};

static const struct shown positions_shown[] = {
    {"position", "", LOOK_TEXT, .width = 8, .column = "query_id"},
    {"x, y, z", "RAS mm", LOOK_POINT, .width = 26, .column = ""},
    {"into head", "x", LOOK_FIXED, .width = 9, .column = "dx", .digits = 3, .none = "-"},
    {"", "y", LOOK_FIXED, .width = 6, .column = "dy", .digits = 3, .none = "-"},
    {"", "z", LOOK_FIXED, .width = 6, .column = "dz", .digits = 3, .none = "-"},
    {"up", "x", LOOK_FIXED, .width = 6, .column = "ux", .digits = 3, .none = "-"},
    {"", "y", LOOK_FIXED, .width = 6, .column = "uy", .digits = 3, .none = "-"},
    {"", "z", LOOK_FIXED, .width = 6, .column = "uz", .digits = 3, .none = "-"},
    {0},
};

static void write_positions_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    (void)report;
    buffer_format(out, "positions of the 10-10 system on %s; directions are of length 1\n",
                  report_is_of_scalp(query->table) ? "the scalp given" : "the head of MNI 152");
}

static void write_calibration_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    (void)report;
    buffer_format(out,
                  "%lld trials: how far the device points to its right (x) and up (y) of what was aimed at, degrees\n",
                  (long long)conus_table_counts(query->table, "n")[0]);
}

/* The weight that a hand or tracker of these errors has, and what speaks against normal errors. */
static void write_calibration_foot(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    (void)report;
    const double *value = conus_table_numbers(query->table, "value");
    const double *p = conus_table_numbers(query->table, "p");
    if (value[2] >= 0.01 && value[2] <= 20 && fmax(fabs(value[0]), fabs(value[1])) <= 45) {
        buffer_format(out, "to copy: --weight gauss=%.4g,bias=%.4g:%.4g\n", value[2], value[0], value[1]);
    } else {
        buffer_text(out, "no --weight has such errors: sigma is 0.01 to 20 degrees, and the bias up to 45\n");
    }
    if (p[5] < 0.05) {
        buffer_format(out, "the errors are hardly normal (kurtosis, p = %.2g)\n", p[5]);
    }
    if (p[6] < 0.05) {
        buffer_format(out, "the errors are hardly alike in all directions (isotropy, p = %.2g)\n", p[6]);
    }
}

static void write_reliability_head(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    (void)report;
    (void)query;
    buffer_text(out, "how often the largest posterior is that of what was meant, by how large it is\n");
}

static void write_reliability_foot(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    buffer_format(out, "log loss %.4g with power %.4g; it is least with power=%.4g behind --prior\n",
                  conus_table_numbers(query->table, "log_loss")[0], report->prior.power,
                  conus_table_numbers(query->table, "power")[0]);
}

/* Of rows of tables but clusters. */
static const struct view *view_of(enum report_rows rows)
{
    static const struct view views[] = {
        [ROWS_ADMISSIONS] = {admissions_shown, NULL, table_write_query, NULL, NULL},
        [ROWS_CHANCES] = {chances_shown, NULL, table_write_query, write_chances_foot, NULL},
        [ROWS_SEGMENTS] = {segments_shown, NULL, write_axis_head, NULL, NULL},
        [ROWS_CONNECTIONS] = {connections_shown, "(no streamline)\n", write_ends_head, NULL, NULL},
        [ROWS_CLEARANCES] = {clearances_shown, "no area, pathway or bundle is that near\n", write_needle_head, NULL,
                             write_needle_end},
        [ROWS_COVERAGES] = {coverages_shown, NULL, write_region_head, NULL, NULL},
        [ROWS_CALIBRATION] = {calibration_shown, NULL, write_calibration_head, write_calibration_foot, NULL},
        [ROWS_POSITIONS] = {positions_shown, NULL, write_positions_head, NULL, NULL},
        [ROWS_RELIABILITY] = {reliability_shown, NULL, write_reliability_head, write_reliability_foot, NULL},
    };
    return &views[rows];
}

/* What one atlas has to say of a query. */
static void write_answer(struct buffer *out, const conus_report *report, const struct view *view,
                         const struct layout *layout, size_t query)
{
    const size_t first = report->queries[query].first_row;
    const size_t end = report_row_end(report, query);
    table_write_atlas(out, report);
    if (first == end && view->empty) {
        buffer_text(out, view->empty);
        return;
    }
    table_write_heading(out, report, layout, false);
    table_write_heading(out, report, layout, true);
    for (size_t i = first; i < end; i++) {
        table_write_row(out, report, layout, &report->rows[i]);
        buffer_text(out, "\n");
    }
}

void report_write_study(struct buffer *out, const conus_report *report)
{
    const struct view *view = view_of(report->kind);
    const struct layout layout = table_lay_out(report, view->columns);
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        const bool more = i + 1 < report->query_count;
        if (query->error) {
            table_write_error(out, report, query, more);
            continue;
        }
        if (view->head) {
            view->head(out, report, query);
        }
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answer(out, of, view, &layout, i);
        }
        if (view->foot) {
            view->foot(out, report, query);
        }
        buffer_text(out, more ? "\n" : "");
    }
    if (view->end) {
        view->end(out, report);
    }
    table_write_sources(out, report);
}
