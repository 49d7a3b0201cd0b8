/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "selection/report/report.h"

static struct cell none(void)
{
    return (struct cell){.type = CELL_NONE};
}

static struct cell text(const char *value)
{
    return value && value[0] ? (struct cell){.type = CELL_TEXT, .text = value} : none();
}

static struct cell integer(uint64_t value)
{
    return (struct cell){.type = CELL_INTEGER, .integer = value};
}

static struct cell number(double value)
{
    return isfinite(value) ? (struct cell){.type = CELL_NUMBER, .number = value} : none();
}

static const conus_object *object_of(const conus_report *report, const struct report_row *row)
{
    return conus_atlas_object(report->atlas, row->result.object);
}

static struct cell get_query(const conus_report *report, const struct report_row *row)
{
    return text(report->queries[row->query].id);
}

const char *report_kind(conus_kind kind)
{
    return kind == CONUS_AREA ? "area" : kind == CONUS_PATHWAY ? "pathway" : "unassigned";
}

static struct cell get_kind(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return text(report_kind(row->result.kind));
}

static struct cell get_index(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return object ? integer(object->label) : none();
}

static struct cell get_name(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return text(object ? object->name : "unassigned");
}

static struct cell get_abbreviation(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return object ? text(object->abbreviation) : none();
}

static struct cell get_rank(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return row->result.rank ? integer(row->result.rank) : none();
}

static struct cell get_score(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.score);
}

/* A ball has no pixels and no rays. */
static bool of_ball(const conus_report *report, const struct report_row *row)
{
    return report->queries[row->query].ball > 0;
}

static struct cell get_pixels(const conus_report *report, const struct report_row *row)
{
    return of_ball(report, row) ? none() : integer(row->result.pixels);
}

static struct cell get_share(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.share);
}

static struct cell get_center(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.center_px);
}

static struct cell get_offset(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(degrees_from_radians(row->result.offset));
}

static struct cell get_distance(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number(row->result.distance);
}

void report_point(const conus_report *report, double point[3])
{
    if (report->options.space == CONUS_LPS) {
        point[0] = 0 - point[0]; /* which makes no "-0" of 0 */
        point[1] = 0 - point[1];
    }
}

static struct cell contact(const conus_report *report, const struct report_row *row, int axis)
{
    double point[3];
    memcpy(point, row->result.contact, sizeof point);
    report_point(report, point);
    return number(point[axis]);
}

static struct cell get_contact_x(const conus_report *report, const struct report_row *row)
{
    return contact(report, row, 0);
}

static struct cell get_contact_y(const conus_report *report, const struct report_row *row)
{
    return contact(report, row, 1);
}

static struct cell get_contact_z(const conus_report *report, const struct report_row *row)
{
    return contact(report, row, 2);
}

/* ---- All layers; n/a in every row of what is only visible ---------------------------------------------------- */

static bool has_census(const conus_report *report, const struct report_row *row)
{
    return report->selector.layers || of_ball(report, row);
}

static struct cell of_layers(const conus_report *report, const struct report_row *row, struct cell cell)
{
    return has_census(report, row) && row->result.object ? cell : none();
}

static struct cell get_pierced(const conus_report *report, const struct report_row *row)
{
    return of_ball(report, row) ? none() : of_layers(report, row, integer(row->result.pierced));
}

static struct cell get_entry(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.entry));
}

static struct cell get_exit(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.exit));
}

static struct cell get_path(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.path));
}

static struct cell get_volume(const conus_report *report, const struct report_row *row)
{
    return has_census(report, row) ? number(row->result.volume) : none();
}

static struct cell get_fraction(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.fraction));
}

static struct cell get_mean_value(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.mean_value));
}

static struct cell get_max_value(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.max_value));
}

/* ---- Columns that only a report of all layers has ----------------------------------------------------------- */

static struct cell get_voxels(const conus_report *report, const struct report_row *row)
{
    bool in_grid = row->result.object || isfinite(row->result.volume);
    return has_census(report, row) && in_grid ? integer(row->result.voxels) : none();
}

static struct cell get_cone_fraction(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.cone_fraction));
}

static struct cell get_sum_value(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.sum_value));
}

static struct cell centroid(const conus_report *report, const struct report_row *row, int axis)
{
    double point[3];
    memcpy(point, row->result.centroid, sizeof point);
    report_point(report, point);
    return of_layers(report, row, number(point[axis]));
}

static struct cell get_centroid_x(const conus_report *report, const struct report_row *row)
{
    return centroid(report, row, 0);
}

static struct cell get_centroid_y(const conus_report *report, const struct report_row *row)
{
    return centroid(report, row, 1);
}

static struct cell get_centroid_z(const conus_report *report, const struct report_row *row)
{
    return centroid(report, row, 2);
}

static struct cell get_unoccluded(const conus_report *report, const struct report_row *row)
{
    return of_layers(report, row, number(row->result.pixels / (double)row->result.pierced));
}

static const struct report_column report_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", get_query, false},
    {"kind", NULL,
     "area, pathway, or unassigned: the part of the cone that met nothing; error: no answer, and name says why",
     get_kind, false},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway", get_index, false},
    {"name", NULL, "name of the area or pathway", get_name, false},
    {"abbreviation", NULL, "abbreviation in the label table", get_abbreviation, false},
    {"rank", NULL, "1 is the best score", get_rank, false},
    {"score", NULL, "value of the ranking named in the settings, higher is better", get_score, false},
    {"pixels", NULL, "pixels of the cone that met it first", get_pixels, false},
    {"share", NULL, "its part of the cone's solid angle; all shares of a query sum to 1", get_share, false},
    {"pierced", NULL, "pixels whose ray passes it, hidden or not", get_pierced, false},
    {"center_px", "pixel", "smallest distance of its pixels to the buffer's centre", get_center, false},
    {"offset_deg", "degree", "smallest angle between its rays and the axis", get_offset, false},
    {"distance_mm", "mm", "distance from the apex to the nearest first contact of any of its pixels", get_distance,
     false},
    {"contact_x", "mm", "first contact on its ray closest to the axis, x", get_contact_x, false},
    {"contact_y", "mm", "the same, y", get_contact_y, false},
    {"contact_z", "mm", "the same, z", get_contact_z, false},
    {"entry_mm", "mm", "nearest entry over all layers", get_entry, false},
    {"exit_mm", "mm", "farthest exit over all layers", get_exit, false},
    {"path_mm", "mm", "mean path length over its rays", get_path, false},
    {"volume_mm3", "mm^3", "its volume inside the cone; of unassigned, that of voxels that are no area's", get_volume,
     false},
    {"fraction", NULL, "that volume as a part of its whole", get_fraction, false},
    {"mean_value", NULL, "mean value of a pathway's voxels in the cone", get_mean_value, false},
    {"max_value", NULL, "largest value of a pathway's voxels in the cone", get_max_value, false},
    {"voxels", NULL, "its voxels whose centre is in the cone", get_voxels, true},
    {"cone_fraction", NULL, "its volume in the cone as a part of that of all areas in the cone", get_cone_fraction,
     true},
    {"sum_value", NULL, "sum of the values of a pathway's voxels in the cone", get_sum_value, true},
    {"centroid_x", "mm", "centroid of its voxels in the cone, of a pathway weighted by value, x", get_centroid_x, true},
    {"centroid_y", "mm", "the same, y", get_centroid_y, true},
    {"centroid_z", "mm", "the same, z", get_centroid_z, true},
    {"unoccluded", NULL, "pixels that met it first as a part of those that pierce it", get_unoccluded, true},
    {NULL, NULL, NULL, NULL, false},
};

/* ---- Columns that only a report on a track has -------------------------------------------------------------- */

static struct cell get_time(const conus_report *report, const struct report_row *row)
{
    return (struct cell){.type = CELL_TIME, .number = report->queries[row->query].step.time_s};
}

static struct cell get_selected(const conus_report *report, const struct report_row *row)
{
    return integer(report_is_selected(report, row));
}

static struct cell get_confirmed(const conus_report *report, const struct report_row *row)
{
    return integer(report_is_confirmed(report, row));
}

static const struct report_column track_columns[] = {
    {"time_s", "s", "time of the step", get_time, false},
    {"selected", NULL, "1 if it is what is selected at this step, else 0", get_selected, false},
    {"confirmed", NULL, "1 if the trigger, pressed at this step, confirms it, else 0", get_confirmed, false},
    {NULL, NULL, NULL, NULL, false},
};

const struct report_column *report_find_column(const char *name)
{
    const struct report_column *column = report_columns;
    while (column->name && strcmp(column->name, name) != 0) {
        column++;
    }
    return column->name ? column : NULL;
}

const struct report_column *report_next_column(const conus_report *report, const struct report_column *column)
{
    switch (report->options.rows) {
    case CONUS_ANSWERS:
        return report->options.format == CONUS_BIDS ? report_next_electrode_column(column)
                                                    : report_next_answer_column(report, column);
    case CONUS_SUMMARIES:
        return report_next_summary_column(column);
    default:
        return report_next_sweep_column(report, column);
    }
}

const struct report_column *report_next_answer_column(const conus_report *report, const struct report_column *column)
{
    column = column ? column + 1 : report_columns;
    while (column->name && column->layers_only && !report->selector.layers) {
        column++;
    }
    if (column == &report_columns[sizeof report_columns / sizeof report_columns[0] - 1] && report->options.tracker) {
        column = track_columns;
    }
    return column->name ? column : NULL;
}
