/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "selection/report.h"

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

static struct cell get_pixels(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return integer(row->result.pixels);
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

/* Columns that the visible layer does not fill; they stand in every table so that readers find one shape. */
static struct cell get_none(const conus_report *report, const struct report_row *row)
{
    (void)report;
    (void)row;
    return none();
}

const struct report_column report_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", get_query},
    {"kind", NULL, "area, pathway, or unassigned: the part of the cone that met nothing", get_kind},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway", get_index},
    {"name", NULL, "name of the area or pathway", get_name},
    {"abbreviation", NULL, "abbreviation in the label table", get_abbreviation},
    {"rank", NULL, "1 is the best score", get_rank},
    {"score", NULL, "value of the ranking named in the settings, higher is better", get_score},
    {"pixels", NULL, "pixels of the cone that met it first", get_pixels},
    {"share", NULL, "its part of the cone's solid angle; all shares of a query sum to 1", get_share},
    {"pierced", NULL, "pixels whose ray passes it, hidden or not", get_none},
    {"center_px", "pixel", "smallest distance of its pixels to the buffer's centre", get_center},
    {"offset_deg", "degree", "smallest angle between its rays and the axis", get_offset},
    {"distance_mm", "mm", "distance from the apex to the nearest first contact of any of its pixels", get_distance},
    {"contact_x", "mm", "first contact on its ray closest to the axis, x", get_contact_x},
    {"contact_y", "mm", "the same, y", get_contact_y},
    {"contact_z", "mm", "the same, z", get_contact_z},
    {"entry_mm", "mm", "nearest entry over all layers", get_none},
    {"exit_mm", "mm", "farthest exit over all layers", get_none},
    {"path_mm", "mm", "mean path length over its rays", get_none},
    {"volume_mm3", "mm^3", "its volume inside the cone", get_none},
    {"fraction", NULL, "that volume as a part of its whole", get_none},
    {"mean_value", NULL, "mean value of a pathway's voxels in the cone", get_none},
    {"max_value", NULL, "largest value of a pathway's voxels in the cone", get_none},
    {NULL, NULL, NULL, NULL},
};
