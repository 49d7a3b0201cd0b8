/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports on how sure an answer is: their columns, and their tables for people. */
#include "base/math3.h"
#include "base/memory.h"
#include "selection/report/report.h"

#include <stdio.h>
#include <string.h>

static conus_status refuse(const char *what)
{
    return fail(CONUS_ERROR_ARGUMENT, "report: %s, but its rows are of something else", what);
}

conus_status conus_report_add_sweep(conus_report *report, const char *query_id, const conus_sweep *sweep)
{
    struct report_row *rows;
    if (report->options.rows != CONUS_ADMISSIONS) {
        return refuse("a sweep");
    }
    conus_status status =
        report_append(&rows, report, query_id, &(struct report_query){.cone = sweep->cone}, sweep->count);
    for (size_t i = 0; !status && i < sweep->count; i++) {
        rows[i].admission = sweep->rows[i];
    }
    return status;
}

conus_status conus_report_add_jitter(conus_report *report, const char *query_id, const conus_jitter *jitter)
{
    struct report_row *rows;
    const struct report_query query = {.cone = jitter->cone, .jitter = jitter->options};
    if (report->options.rows != CONUS_CHANCES) {
        return refuse("an answer under errors of the pose");
    }
    conus_status status = report_append(&rows, report, query_id, &query, jitter->count);
    for (size_t i = 0; !status && i < jitter->count; i++) {
        rows[i].chance = jitter->rows[i];
    }
    return status;
}

/* ---- Columns ---- */

static struct cell integer(uint64_t value)
{
    return (struct cell){.type = CELL_INTEGER, .integer = value};
}

static struct cell number(double value)
{
    return isfinite(value) ? (struct cell){.type = CELL_NUMBER, .number = value} : (struct cell){.type = CELL_NONE};
}

static const struct report_query *query_of(const conus_report *report, const struct report_row *row)
{
    return &report->queries[row->query];
}

static struct cell get_angle(const conus_report *report, const struct report_row *row)
{
    return number(degrees_from_radians(query_of(report, row)->cone.angle));
}

static struct cell get_place(const conus_report *report, const struct report_row *row)
{
    return integer((size_t)(row - report->rows) - query_of(report, row)->first_row + 1);
}

static struct cell get_opening(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(degrees_from_radians(row->admission.angle));
}

static struct cell get_half(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(degrees_from_radians(row->admission.angle / 2));
}

static struct cell get_margin(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(degrees_from_radians(row->admission.margin));
}

static struct cell get_distance(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->admission.distance);
}

static struct cell point(const conus_report *report, const struct report_row *row, int axis)
{
    double at[3];
    memcpy(at, row->admission.point, sizeof at);
    report_point(report, at);
    return number(at[axis]);
}

static struct cell get_x(const conus_report *report, const struct report_row *row)
{
    return point(report, row, 0);
}

static struct cell get_y(const conus_report *report, const struct report_row *row)
{
    return point(report, row, 1);
}

static struct cell get_z(const conus_report *report, const struct report_row *row)
{
    return point(report, row, 2);
}

static struct cell get_measured(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return (struct cell){.type = CELL_TEXT, .text = row->admission.is_surface ? "surface" : "voxel centre"};
}

static struct cell get_chance_rank(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return row->chance.rank ? integer(row->chance.rank) : (struct cell){.type = CELL_NONE};
}

static struct cell get_hit(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.hit);
}

static struct cell get_hit_error(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.hit_error);
}

static struct cell get_seen(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.seen);
}

static struct cell get_in_cone(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.in_cone);
}

static struct cell get_share(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.share);
}

static struct cell get_share_deviation(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->chance.share_deviation);
}

static struct cell get_samples(const conus_report *report, const struct report_row *row)
{
    return integer(query_of(report, row)->jitter.samples);
}

static struct cell get_tilt(const conus_report *report, const struct report_row *row)
{
    return number(degrees_from_radians(query_of(report, row)->jitter.tilt));
}

static struct cell get_shift(const conus_report *report, const struct report_row *row)
{
    return number(query_of(report, row)->jitter.shift);
}

static const struct report_column share_columns[] = {
    {"angle_deg", "degree", "full opening angle of the cone", get_angle, false},
    {NULL, NULL, NULL, NULL, false},
};

static const struct report_column admission_columns[] = {
    {"rank", NULL, "1 is admitted first", get_place, false},
    {"angle_deg", "degree", "full opening angle of the narrowest cone that holds some of it", get_opening, false},
    {"half_angle_deg", "degree", "half of that: the angle to the axis", get_half, false},
    {"margin_deg", "degree", "by how much the cone must open further for the next one", get_margin, false},
    {"distance_mm", "mm", "distance from the apex to what is admitted first", get_distance, false},
    {"x", "mm", "where that is, x", get_x, false},
    {"y", "mm", "the same, y", get_y, false},
    {"z", "mm", "the same, z", get_z, false},
    {"measured", NULL, "what that is: voxel centre, or surface of a mesh; exact either way", get_measured, false},
    {NULL, NULL, NULL, NULL, false},
};

static const struct report_column chance_columns[] = {
    {"rank", NULL, "1 is the most probable hit", get_chance_rank, false},
    {"p_hit", NULL, "probability that it is the one hit; of a query they sum to 1", get_hit, false},
    {"p_hit_error", NULL, "standard error of p_hit, on the safe side", get_hit_error, false},
    {"p_seen", NULL, "probability that some pixel meets it first", get_seen, false},
    {"p_in_cone", NULL, "probability that it is in the cone at all; needs all layers", get_in_cone, false},
    {"mean_share", NULL, "mean part of the cone's solid angle; of a query they sum to 1", get_share, false},
    {"sd_share", NULL, "standard deviation of that part from sample to sample", get_share_deviation, false},
    {"samples", NULL, "poses that were looked from", get_samples, false},
    {"error_deg", "degree", "standard deviation of the tilt of the axis, about each of two axes", get_tilt, false},
    {"error_mm", "mm", "standard deviation of the position, along each of three axes", get_shift, false},
    {NULL, NULL, NULL, NULL, false},
};

/* Those of answers that stand before the own ones; shares have all of them. */
static const char *const common[] = {"query", "kind", "index", "name", "abbreviation"};

enum { COMMON_COUNT = sizeof common / sizeof common[0] };

static const struct report_column *next_common(const struct report_column *column)
{
    for (size_t i = 0; i < COMMON_COUNT; i++) {
        if (column == report_find_column(common[i])) {
            return i + 1 < COMMON_COUNT ? report_find_column(common[i + 1]) : NULL;
        }
    }
    return NULL;
}

const struct report_column *report_next_sweep_column(const conus_report *report, const struct report_column *column)
{
    static const struct report_column *const tables[] = {NULL, share_columns, admission_columns, chance_columns};
    const struct report_column *own = tables[report->options.rows];
    for (const struct report_column *at = own; at->name; at++) {
        if (column == at) {
            return at[1].name ? &at[1] : NULL;
        }
    }
    if (!column) {
        return report_find_column(common[0]);
    }
    const struct report_column *next =
        report->options.rows == CONUS_SHARES ? report_next_answer_column(report, column) : next_common(column);
    return next ? next : own;
}

/* ---- Tables for people ---- */

static const char *name_of(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = conus_atlas_object(report->atlas, row->result.object);
    return object ? object->name : "(nothing met)";
}

/* "37", or nothing of what is unassigned. */
static const char *label_of(char out[16], const conus_report *report, const struct report_row *row)
{
    const conus_object *object = conus_atlas_object(report->atlas, row->result.object);
    out[0] = '\0';
    if (object) {
        snprintf(out, 16, "%u", object->label);
    }
    return out;
}

static void write_admission(struct buffer *out, const conus_report *report, const struct report_row *row, int width)
{
    char label[16];
    double at[3];
    const conus_admission *admission = &row->admission;
    memcpy(at, admission->point, sizeof at);
    report_point(report, at);
    buffer_format(out, "%9.3f  ", degrees_from_radians(admission->angle));
    if (isfinite(admission->margin)) {
        buffer_format(out, "%9.3f  ", degrees_from_radians(admission->margin));
    } else {
        buffer_format(out, "%9s  ", "");
    }
    report_write_name(out, name_of(report, row), width);
    buffer_format(out, "  %10s  %9.2f  %8.2f %8.2f %8.2f\n", label_of(label, report, row), admission->distance, at[0],
                  at[1], at[2]);
}

static void write_admission_heading(struct buffer *out, int width)
{
    static const char form[] = "%9s  %9s  %-*s  %10s  %9s  %26s\n";
    buffer_format(out, form, "angle", "margin", width, "name", "label", "distance", "first reached at x, y, z");
    buffer_format(out, form, "degrees", "degrees", width, "", "", "mm", "mm");
}

static void write_chance(struct buffer *out, const conus_report *report, const struct report_row *row, int width)
{
    char rank[16] = "";
    char label[16];
    const conus_chance *chance = &row->chance;
    if (chance->rank) {
        snprintf(rank, sizeof rank, "%u", chance->rank);
    }
    buffer_format(out, "%4s  ", rank);
    report_write_name(out, name_of(report, row), width);
    buffer_format(out, "  %10s  %6.2f %%  %6.2f %%  %6.2f %%", label_of(label, report, row), 100 * chance->hit,
                  100 * chance->hit_error, 100 * chance->seen);
    if (report->selector.layers && isfinite(chance->in_cone)) {
        buffer_format(out, "  %6.2f %%", 100 * chance->in_cone);
    } else if (report->selector.layers) {
        buffer_format(out, "  %8s", "");
    }
    buffer_format(out, "  %6.2f %%  %6.2f %%\n", 100 * chance->share, 100 * chance->share_deviation);
}

static void write_chance_heading(struct buffer *out, const conus_report *report, int width)
{
    bool layers = report->selector.layers;
    buffer_format(out, "%4s  %-*s  %10s  %8s  %8s  %8s%s%s  %8s  %8s\n", "rank", width, "name", "label", "hit", "error",
                  "seen", layers ? "  " : "", layers ? " in cone" : "", "share", "varies");
    buffer_format(out, "%4s  %-*s  %10s  %8s  %8s  %8s%s  %8s  %8s\n", "", width, "", "", "", "of hit", "",
                  layers ? "          " : "", "mean", "by");
}

static void write_rows_of(struct buffer *out, const conus_report *report, size_t index, int width)
{
    const struct report_query *query = &report->queries[index];
    bool chances = report->options.rows == CONUS_CHANCES;
    if (chances) {
        write_chance_heading(out, report, width);
    } else {
        write_admission_heading(out, width);
    }
    for (size_t i = query->first_row; i < report->row_count && report->rows[i].query == index; i++) {
        (chances ? write_chance : write_admission)(out, report, &report->rows[i], width);
    }
    if (chances) {
        buffer_format(out,
                      "%u poses with errors of %.4g degrees about each axis and %.4g mm along each (standard "
                      "deviations); ranked by %s; engine %s\n",
                      query->jitter.samples, degrees_from_radians(query->jitter.tilt), query->jitter.shift,
                      report->score, report->engine);
    }
}

/* ---- Shares by angle ---- */

enum { ANGLES_IN_A_TABLE = 10 };

/* Queries first to end - 1: one pose, several angles. */
struct block {
    size_t first, end;
};

static struct block block_at(const conus_report *report, size_t first)
{
    struct block block = {first, first + 1};
    while (block.end < report->query_count && !report->queries[block.end].error &&
           block.end - first < ANGLES_IN_A_TABLE &&
           strcmp(report->queries[block.end].id, report->queries[first].id) == 0) {
        block.end++;
    }
    return block;
}

static size_t row_end(const conus_report *report, size_t query)
{
    return query + 1 < report->query_count ? report->queries[query + 1].first_row : report->row_count;
}

/* An object's results at the block's angles; NULL where there is none. */
struct line {
    const conus_result *at[ANGLES_IN_A_TABLE];
};

struct shares {
    struct block block;
    struct line *lines; /* [object_count + 1] */
};

static void fill_lines(const struct shares *shares, const conus_report *report)
{
    for (size_t i = shares->block.first; i < shares->block.end; i++) {
        for (size_t r = report->queries[i].first_row; r < row_end(report, i); r++) {
            const conus_result *result = &report->rows[r].result;
            shares->lines[result->object].at[i - shares->block.first] = result;
        }
    }
}

static void write_shares_row(struct buffer *out, const conus_report *report, const struct shares *shares,
                             const struct report_row *row, int width)
{
    char label[16];
    const struct line *line = &shares->lines[row->result.object];
    report_write_name(out, name_of(report, row), width);
    buffer_format(out, "  %10s", label_of(label, report, row));
    for (size_t i = 0; i < shares->block.end - shares->block.first; i++) {
        if (line->at[i]) {
            buffer_format(out, "  %6.2f", 100 * line->at[i]->share);
        } else {
            buffer_format(out, "  %6s", "");
        }
    }
    buffer_text(out, "\n");
}

/* Objects that the angle of query `query` brings, or what met nothing. */
static void write_new_rows(struct buffer *out, const conus_report *report, const struct shares *shares, size_t query,
                           bool nothing, int width)
{
    for (size_t r = report->queries[query].first_row; r < row_end(report, query); r++) {
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

/* Objects in the order in which the angles bring them, what met nothing last. */
static void write_shares(struct buffer *out, const conus_report *report, struct block block, int width)
{
    struct shares shares = {block, memory_zeroed(report->atlas->object_count + 1, sizeof *shares.lines)};
    if (!shares.lines) {
        out->failed = true;
        return;
    }
    fill_lines(&shares, report);
    buffer_format(out, "%-*s  %10s  share of cone in %% at an angle of ... degrees\n%-*s  %10s", width, "name", "label",
                  width, "", "");
    for (size_t i = block.first; i < block.end; i++) {
        buffer_format(out, "  %6.4g", degrees_from_radians(report->queries[i].cone.angle));
    }
    buffer_text(out, "\n");
    for (size_t i = block.first; i < block.end; i++) {
        write_new_rows(out, report, &shares, i, false, width);
    }
    write_new_rows(out, report, &shares, block.first, true, width);
    memory_free(shares.lines);
}

void report_write_sweep(struct buffer *out, const conus_report *report)
{
    int width = report_name_width(report);
    for (size_t i = 0; i < report->query_count;) {
        struct block block = {i, i + 1};
        if (report->queries[i].error) {
            report_write_error(out, &report->queries[i], i + 1 < report->query_count);
            i++;
            continue;
        }
        report_write_query(out, report, &report->queries[i]);
        if (report->options.rows == CONUS_SHARES) {
            block = block_at(report, i);
            write_shares(out, report, block, width);
        } else {
            write_rows_of(out, report, i, width);
        }
        i = block.end;
        buffer_text(out, i < report->query_count ? "\n" : "");
    }
    report_write_sources(out, report);
}
