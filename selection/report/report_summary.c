/* SPDX-License-Identifier: BSD-3-Clause */
/* One row per answer: what is best, what comes next, and by how much. */
#include "selection/report/report.h"

#include <math.h>

static struct cell number(double value)
{
    return (struct cell){.type = isfinite(value) ? CELL_NUMBER : CELL_NONE, .number = value};
}

/* The result behind the best one, or what is unassigned. */
static const struct report_row *next_row(const conus_report *report, const struct report_row *row)
{
    const struct report_row *end = report->rows + report->row_count;
    return row + 1 < end && row[1].query == row->query ? row + 1 : row;
}

static const conus_object *runner_up(const conus_report *report, const struct report_row *row)
{
    const struct report_row *next = next_row(report, row);
    return next == row ? NULL : conus_atlas_object(report->atlas, next->result.object);
}

static struct cell get_runner_up(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = runner_up(report, row);
    return (struct cell){.type = object ? CELL_TEXT : CELL_NONE, .text = object ? object->name : NULL};
}

static struct cell get_runner_up_index(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = runner_up(report, row);
    return (struct cell){.type = object ? CELL_INTEGER : CELL_NONE, .integer = object ? object->label : 0};
}

static struct cell get_runner_up_share(const conus_report *report, const struct report_row *row)
{
    return number(runner_up(report, row) ? next_row(report, row)->result.share : NAN);
}

static struct cell get_margin(const conus_report *report, const struct report_row *row)
{
    return number(runner_up(report, row) ? row->result.score - next_row(report, row)->result.score : NAN);
}

static struct cell get_unassigned(const conus_report *report, const struct report_row *row)
{
    while (next_row(report, row) != row) {
        row++;
    }
    return number(row->result.object ? NAN : row->result.share);
}

static struct cell get_error(const conus_report *report, const struct report_row *row)
{
    const char *error = report->queries[row->query].error;
    return (struct cell){.type = error ? CELL_TEXT : CELL_NONE, .text = error};
}

static const struct report_column own[] = {
    {"runner_up", NULL, "name of the area or pathway with the second best score", get_runner_up, false},
    {"runner_up_index", NULL, "its index", get_runner_up_index, false},
    {"runner_up_share", NULL, "its share", get_runner_up_share, false},
    {"margin", NULL, "score of the best less that of the runner-up", get_margin, false},
    {"unassigned_share", NULL, "share of what met nothing", get_unassigned, false},
    {"error", NULL, "why there is no answer; then kind is error, and all else is missing", get_error, false},
    {NULL, NULL, NULL, NULL, false},
};

/* ---- What a table of electrodes gets ---------------------------------------------------------------------------- */

static struct cell get_area(const conus_report *report, const struct report_row *row)
{
    return report_find_column("name")->get(report, row);
}

static struct cell get_area_index(const conus_report *report, const struct report_row *row)
{
    return report_find_column("index")->get(report, row);
}

static struct cell get_area_share(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.share);
}

static struct cell get_area_distance(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.distance);
}

static const struct report_column of_electrodes[] = {
    {"area", NULL, "name of the area or pathway with the best score at the contact, or unassigned", get_area, false},
    {"area_index", NULL, "the atlas's own label of it", get_area_index, false},
    {"area_share", NULL, "its part of the ball around the contact, or of the cone", get_area_share, false},
    {"area_distance_mm", "mm", "how far it is from the contact", get_area_distance, false},
    {"runner_up", NULL, "name of the area or pathway with the second best score", get_runner_up, false},
    {"runner_up_share", NULL, "its share", get_runner_up_share, false},
    {"area_error", NULL, "why there is no answer", get_error, false},
    {NULL, NULL, NULL, NULL, false},
};

const struct report_column *report_next_electrode_column(const struct report_column *column)
{
    const struct report_column *next = column ? column + 1 : of_electrodes;
    return next->name ? next : NULL;
}

/* ---- Summaries -------------------------------------------------------------------------------------------------- */

/* As in a report of answers, of the best. */
static const char *const common[] = {"query", "kind", "index", "name", "share", "score", "distance_mm"};

enum { COMMON_COUNT = sizeof common / sizeof common[0] };

const struct report_column *report_next_summary_column(const struct report_column *column)
{
    for (size_t i = 0; i < COMMON_COUNT && column; i++) {
        if (column == report_find_column(common[i])) {
            return i + 1 < COMMON_COUNT ? report_find_column(common[i + 1]) : own;
        }
    }
    const struct report_column *next = column ? column + 1 : report_find_column(common[0]);
    return next->name ? next : NULL;
}
