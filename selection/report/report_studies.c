/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables for people of studies: one writer, and lists of what it shows of each. */
#include "base/geometry/math3.h"
#include "selection/report/parts.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum look {
    LOOK_NAME,    /* The row's object; `none` where it has none. */
    LOOK_TEXT,    /* A text; `none` where the column `beside` is n/a. As wide as the longest of those with, or without
                     `beside`. */
    LOOK_LABEL,   /* The label of the object. */
    LOOK_COUNT,   /* A count. */
    LOOK_FIXED,   /* A number with `digits` behind the point. */
    LOOK_PERCENT, /* Likewise, a hundred times as much. */
    LOOK_SHORT,   /* A number with 5 digits that count. */
    LOOK_VOLUME,  /* A volume, by table_volume(). */
    LOOK_SHARE,   /* A share of the rays, by text_share(). */
    LOOK_STRIKES, /* A clearance; where there is none a word by the distance in the column `beside`. */
    LOOK_POINT    /* Columns `column`x, y and z. */
};

/* A column of the table for people. */
struct shown {
    const char *title, *unit; /* above each other; NULL = the unit of the space */
    enum look look;
    int width; /* of texts the least; of names by the report */
    const char *column;
    int digits;
    const char *none;  /* for n/a; NULL = "" */
    const char *after; /* each value; NULL = "" */
    const char *beside;
    bool layers_only;
};

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
    {"in cone", "", LOOK_PERCENT, .width = 8, .column = "p_in_cone", .digits = 2, .after = " %", .layers_only = true},
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
    {"peak", "", LOOK_SHORT, .width = 10, .column = "peak"},
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
    {"value", "", LOOK_SHORT, .width = 10, .column = "value"},
    {"low", "95 %", LOOK_SHORT, .width = 10, .column = "low"},
    {"high", "95 %", LOOK_SHORT, .width = 10, .column = "high"},
    {"p", "", LOOK_SHORT, .width = 10, .column = "p"},
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
static const struct view *view_of(conus_rows rows)
{
    static const struct view views[] = {
        [CONUS_ROWS_ADMISSIONS] = {admissions_shown, NULL, table_write_query, NULL, NULL},
        [CONUS_ROWS_CHANCES] = {chances_shown, NULL, table_write_query, write_chances_foot, NULL},
        [CONUS_ROWS_SEGMENTS] = {segments_shown, NULL, write_axis_head, NULL, NULL},
        [CONUS_ROWS_CONNECTIONS] = {connections_shown, "(no streamline)\n", write_ends_head, NULL, NULL},
        [CONUS_ROWS_CLEARANCES] = {clearances_shown, "no area, pathway or bundle is that near\n", write_needle_head,
                                   NULL, write_needle_end},
        [CONUS_ROWS_COVERAGES] = {coverages_shown, NULL, write_region_head, NULL, NULL},
        [CONUS_ROWS_CALIBRATION] = {calibration_shown, NULL, write_calibration_head, write_calibration_foot, NULL},
        [CONUS_ROWS_POSITIONS] = {positions_shown, NULL, write_positions_head, NULL, NULL},
        [CONUS_ROWS_RELIABILITY] = {reliability_shown, NULL, write_reliability_head, write_reliability_foot, NULL},
    };
    return &views[rows];
}

static const char *text_of(const struct report_row *row, const struct shown *shown)
{
    const conus_column *beside = conus_table_find(row->of_table.table, shown->beside ? shown->beside : "");
    bool is_none = beside && beside->missing && beside->missing[row->of_table.index];
    return is_none ? shown->none : report_text(row, shown->column);
}

/* The columns on a terminal that names and texts need: of all reports that are joined. */
static int find_width(const conus_report *report, const struct shown *shown, const struct shown *columns)
{
    int width = shown->look == LOOK_NAME ? table_name_width(report) : shown->width;
    for (const struct shown *other = columns; shown->look == LOOK_TEXT && other->title; other++) {
        bool is_alike = other->look == LOOK_TEXT && !other->beside == !shown->beside;
        for (const conus_report *of = report; of && is_alike; of = of->next) {
            for (size_t i = 0; i < of->row_count; i++) {
                const struct report_row *row = &of->rows[i];
                width = of->queries[row->query].error ? width : table_wider(width, text_of(row, other));
            }
        }
    }
    return width;
}

enum { SHOWN_LIMIT = 16, CELL_SIZE = 128 };

struct layout {
    const struct view *view;
    int widths[SHOWN_LIMIT];
};

static bool is_left(const struct shown *shown)
{
    return shown->look == LOOK_NAME || shown->look == LOOK_TEXT;
}

static void write_point(char out[CELL_SIZE], const conus_report *report, const struct report_row *row,
                        const struct shown *shown)
{
    double p[3];
    const int digits = table_digits(report);
    const int width = (shown->width - 10) / 2; /* of y and z: x has 8, and a space is before each */
    for (int a = 0; a < 3; a++) {
        char column[32];
        snprintf(column, sizeof column, "%s%c", shown->column, "xyz"[a]);
        p[a] = report_number(row, column);
    }
    if (isfinite(p[0] + p[1] + p[2])) { /* of a position without a normal it is n/a */
        snprintf(out, CELL_SIZE, "%8.*f %*.*f %*.*f", digits, p[0], width, digits, p[1], width, digits, p[2]);
    }
}

/* Writes a number; nothing where it is n/a. */
static void write_number(char out[CELL_SIZE], const conus_report *report, const struct report_row *row,
                         const struct shown *shown)
{
    const double number = report_number(row, shown->column);
    if (!isfinite(number)) {
        return;
    }
    if (shown->look == LOOK_SHORT) {
        snprintf(out, CELL_SIZE, "%.5g", number);
    } else if (shown->look == LOOK_VOLUME) {
        table_volume(out, number);
    } else if (shown->look == LOOK_SHARE) {
        text_share(out, number, report_share_digits(report));
    } else if (shown->look == LOOK_STRIKES && !(number > 0)) {
        snprintf(out, CELL_SIZE, "%s", report_number(row, shown->beside) > 0 ? "touches" : "pierces");
    } else {
        snprintf(out, CELL_SIZE, "%.*f", shown->digits, shown->look == LOOK_PERCENT ? 100 * number : number);
    }
}

/* Writes a value that stands at the right. */
static void write_right(struct buffer *out, const conus_report *report, const struct report_row *row,
                        const struct shown *shown)
{
    char text[CELL_SIZE] = "";
    const conus_column *column = conus_table_find(row->of_table.table, shown->column ? shown->column : "");
    if (shown->look == LOOK_LABEL) {
        table_label(text, report, row->of_table.object);
    } else if (shown->look == LOOK_POINT) {
        write_point(text, report, row, shown);
    } else if (shown->look != LOOK_COUNT) {
        write_number(text, report, row, shown);
    } else if (!column->missing || !column->missing[row->of_table.index]) {
        snprintf(text, sizeof text, "%lld", (long long)column->counts[row->of_table.index]);
    }
    const char *after = text[0] && shown->after ? shown->after : "";
    const char *none = shown->none ? shown->none : "";
    buffer_format(out, "%*s%s", shown->width - (int)strlen(after), text[0] ? text : none, after);
}

static void write_heading(struct buffer *out, const conus_report *report, const struct layout *layout, bool is_unit)
{
    for (const struct shown *shown = layout->view->columns; shown->title; shown++) {
        char axes[TABLE_AXES_SIZE];
        const char *title = shown->unit ? shown->title : table_axes(axes, report, shown->title);
        const char *unit = shown->unit ? shown->unit : conus_space_unit(report->frame.space);
        const int width = layout->widths[shown - layout->view->columns];
        if (!shown->layers_only || report->selector.layers) {
            buffer_format(out, "%s%*s", shown == layout->view->columns ? "" : "  ", is_left(shown) ? -width : width,
                          is_unit ? unit : title);
        }
    }
    buffer_text(out, "\n");
}

static void write_row(struct buffer *out, const conus_report *report, const struct layout *layout,
                      const struct report_row *row)
{
    const uint32_t object = row->of_table.object;
    for (const struct shown *shown = layout->view->columns; shown->title; shown++) {
        if (shown->layers_only && !report->selector.layers) {
            continue;
        }
        buffer_text(out, shown == layout->view->columns ? "" : "  ");
        if (is_left(shown)) {
            const char *text = shown->look == LOOK_TEXT ? text_of(row, shown)
                               : object                 ? table_name(report, object)
                                                        : shown->none;
            table_write_name(out, text, layout->widths[shown - layout->view->columns]);
        } else {
            write_right(out, report, row, shown);
        }
    }
    buffer_text(out, "\n");
}

/* What one atlas has to say of a query. */
static void write_answer(struct buffer *out, const conus_report *report, const struct layout *layout, size_t query)
{
    const size_t first = report->queries[query].first_row;
    const size_t end = report_row_end(report, query);
    table_write_atlas(out, report);
    if (first == end && layout->view->empty) {
        buffer_text(out, layout->view->empty);
        return;
    }
    write_heading(out, report, layout, false);
    write_heading(out, report, layout, true);
    for (size_t i = first; i < end; i++) {
        write_row(out, report, layout, &report->rows[i]);
    }
}

void report_write_study(struct buffer *out, const conus_report *report)
{
    struct layout layout = {.view = view_of(report->options.rows)};
    assert(layout.view->columns);
    for (const struct shown *shown = layout.view->columns; shown->title; shown++) {
        layout.widths[shown - layout.view->columns] = find_width(report, shown, layout.view->columns);
    }
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        const bool more = i + 1 < report->query_count;
        if (query->error) {
            table_write_error(out, report, query, more);
            continue;
        }
        layout.view->head(out, report, query);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answer(out, of, &layout, i);
        }
        if (layout.view->foot) {
            layout.view->foot(out, report, query);
        }
        buffer_text(out, more ? "\n" : "");
    }
    if (layout.view->end) {
        layout.view->end(out, report);
    }
    table_write_sources(out, report);
}
