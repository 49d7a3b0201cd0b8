/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables of columns of all kinds of reports, and how a cell is read from a row. */
#include "selection/report/report.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "selection/plan/together/together.h"
#include "selection/report/parts.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

static const conus_object *object_of(const conus_report *report, const struct report_row *row)
{
    return conus_atlas_object(report->atlas, row->result.object);
}

void report_point(const conus_report *report, double point[3])
{
    conus_frame_from_world(point, &report->frame, point);
}

const char *report_units(const conus_report *report, const struct report_column *column)
{
    return column_is_place(column->type) ? conus_space_unit(report->frame.space) : column->units;
}

unsigned report_needs_met(const conus_report *report, const struct report_row *row)
{
    const struct report_query *query = &report->queries[row->query];
    unsigned there = query->asked.ball > 0 ? 0 : NEEDS_RAYS;
    there |= !query->is_point && (query->asked.ball > 0 || report->selector.layers) ? NEEDS_CENSUS : 0;
    there |= row->result.object ? NEEDS_OBJECT : 0;
    there |= row->result.kind == CONUS_KIND_BUNDLE ? NEEDS_BUNDLE : 0;
    return there;
}

/* Entries of the tables: where a value lies, after its name, units and description. */
#define OF_ROW(kind, member) .type = COLUMN_##kind, .offset = offsetof(struct report_row, member)
#define OF_QUERY(kind, member)                                                                                         \
    .type = COLUMN_##kind, .offset = offsetof(struct report_query, member), .home = HOME_QUERY
#define NAMED(getter) .type = COLUMN_NAME, .get = getter
#define OF_BUNDLE(kind, member) OF_ROW(kind, result.member), .needs = NEEDS_BUNDLE, .only = ONLY_LAYERS | ONLY_BUNDLES

#define OF_DOSE(kind, member) OF_ROW(kind, result.member), .needs = NEEDS_CENSUS, .only = ONLY_DOSES

static struct cell get_query(const conus_report *report, const struct report_row *row)
{
    return text_cell(report->queries[row->query].id);
}

static struct cell get_kind(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return text_cell(atlas_kind_word(row->result.kind));
}

static struct cell get_index(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return object ? integer_cell(object->label) : no_cell();
}

static struct cell get_name(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return text_cell(object ? object->name : "unassigned");
}

static struct cell get_abbreviation(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = object_of(report, row);
    return object ? text_cell(object->abbreviation) : no_cell();
}

static struct cell get_voxels(const conus_report *report, const struct report_row *row)
{
    (void)report;
    bool in_grid = row->result.object || isfinite(row->result.volume);
    return in_grid ? integer_cell(row->result.voxels) : no_cell();
}

static struct cell get_unoccluded(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return number_cell(row->result.pixels / (double)row->result.pierced);
}

static struct cell get_atlas(const conus_report *report, const struct report_row *row)
{
    (void)row;
    return text_cell(report->name);
}

/* The second column of a report that has a name. */
static const struct report_column atlas_column = {"atlas", NULL, "name of the atlas that is asked", NAMED(get_atlas)};

/* Those behind it of a report with marks. */
static const struct report_column row_column = {"row",
                                                NULL,
                                                "number of the pose in its file, from 1",
                                                .type = COLUMN_LARGE_COUNT,
                                                .offset = offsetof(struct report_query, number),
                                                .home = HOME_MARKS};
static const struct report_column time_column = {
    "time_s",          "s", "time of the pose", .type = COLUMN_TIME, .offset = offsetof(struct report_query, time_s),
    .home = HOME_MARKS};

void report_kept_column(struct report_column *out, const char *name, size_t index)
{
    *out = (struct report_column){.name = name,
                                  .description = "the column of this name in the file of poses",
                                  .type = COLUMN_TEXT,
                                  .offset = index,
                                  .home = HOME_KEPT};
}

static const struct report_column answer_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", NAMED(get_query)},
    {"kind", NULL, "area, pathway, bundle, unassigned: the part of the cone that hits nothing, or error: name says why",
     NAMED(get_kind)},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway or bundle", NAMED(get_index)},
    {"name", NULL, "name of the area, pathway or bundle", NAMED(get_name)},
    {"abbreviation", NULL, "abbreviation in the label table", NAMED(get_abbreviation)},
    {"rank", NULL, "1 is the best score", OF_ROW(RANK, result.rank)},
    {"score", NULL, "value of the ranking named in the settings, higher is better", OF_ROW(NUMBER, result.score)},
    {"pixels", NULL, "pixels of the cone that hit it first", OF_ROW(COUNT, result.pixels), .needs = NEEDS_RAYS},
    {"share", NULL, "its part of the cone's solid angle; all shares of a query sum to 1", OF_ROW(NUMBER, result.share)},
    {"pierced", NULL, "pixels whose ray passes it, hidden or not", OF_ROW(COUNT, result.pierced),
     .needs = NEEDS_RAYS | NEEDS_LAYERS},
    {"center_px", "pixel", "smallest distance of its pixels to the buffer's centre", OF_ROW(NUMBER, result.centre_px)},
    {"offset_deg", "degree", "smallest angle between its rays and the axis", OF_ROW(NUMBER, result.offset)},
    {"distance_mm", "mm", "distance from the apex to the nearest first contact of any of its pixels",
     OF_ROW(NUMBER, result.distance)},
    TABLE_XYZ("contact_", "first contact on its ray closest to the axis", OF_ROW, result.contact),
    {"atlas_x", "mm", "where that is in the atlas's own space, x", OF_ROW(OWN_X, result.contact), .only = ONLY_MOVED},
    {"atlas_y", "mm", "the same, y", OF_ROW(OWN_Y, result.contact), .only = ONLY_MOVED},
    {"atlas_z", "mm", "the same, z", OF_ROW(OWN_Z, result.contact), .only = ONLY_MOVED},
    {"entry_mm", "mm", "nearest entry over all layers", OF_ROW(NUMBER, result.entry), .needs = NEEDS_LAYERS},
    {"exit_mm", "mm", "farthest exit over all layers", OF_ROW(NUMBER, result.exit), .needs = NEEDS_LAYERS},
    {"path_mm", "mm", "mean path length over its rays", OF_ROW(NUMBER, result.path), .needs = NEEDS_LAYERS},
    {"volume_mm3", "mm^3", "its volume inside the cone; of unassigned, that of voxels that are no area's",
     OF_ROW(NUMBER, result.volume), .needs = NEEDS_CENSUS},
    {"fraction", NULL, "that volume as a part of its whole", OF_ROW(NUMBER, result.fraction), .needs = NEEDS_LAYERS},
    {"mean_value", NULL, "mean value of its voxels in the cone, of a pathway or an area of probabilities",
     OF_ROW(NUMBER, result.mean_value), .needs = NEEDS_LAYERS},
    {"max_value", NULL, "largest value of its voxels in the cone, likewise", OF_ROW(NUMBER, result.max_value),
     .needs = NEEDS_LAYERS},
    {"voxels", NULL, "its voxels whose centre is in the cone", .get = get_voxels, .needs = NEEDS_CENSUS,
     .only = ONLY_LAYERS},
    {"cone_fraction", NULL, "its volume in the cone as a part of that of all areas in the cone",
     OF_ROW(NUMBER, result.cone_fraction), .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"sum_value", NULL, "sum of the values of its voxels in the cone, likewise", OF_ROW(NUMBER, result.sum_value),
     .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"centroid_x", "mm", "centroid of its voxels in the cone, of a pathway weighted by value, x",
     OF_ROW(X, result.centroid), .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"centroid_y", "mm", "the same, y", OF_ROW(Y, result.centroid), .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"centroid_z", "mm", "the same, z", OF_ROW(Z, result.centroid), .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"unoccluded", NULL, "pixels that hit it first, as a part of those that pierce it", .get = get_unoccluded,
     .needs = NEEDS_LAYERS, .only = ONLY_LAYERS},
    {"streamlines", NULL, "of a bundle: its streamlines that come into the cone", OF_BUNDLE(LARGE_COUNT, streamlines)},
    {"streamlines_total", NULL, "of a bundle: all of its streamlines", OF_BUNDLE(LARGE_COUNT, streamlines_total)},
    {"length_mm", "mm", "length of the parts of its streamlines in the cone", OF_BUNDLE(NUMBER, length)},
    TABLE_XYZ("near_", "the point of these parts that is nearest to the apex", OF_BUNDLE, near),
    {"along", NULL, "how far along its streamline that is, 0 to 1 of its length, in the direction of the bundle",
     OF_BUNDLE(NUMBER, along)},
    {"weight", NULL, "its part of the weights of all rays; all parts of a query sum to 1",
     OF_ROW(NUMBER, result.weight), .only = ONLY_WEIGHT},
    {"weight_error", NULL, "standard error of the weight, from the pixels at its outline",
     OF_ROW(NUMBER, result.weight_error), .only = ONLY_WEIGHT},
    {"posterior", NULL, "probability that it is meant, of what is hit first", OF_ROW(NUMBER, result.posterior),
     .only = ONLY_POSTERIOR},
    {"dose", NULL, "integral of the weight over its part in the cone: mm^3, of a bundle mm, times the weight's unit",
     OF_DOSE(NUMBER, dose)},
    {"dose_share", NULL, "the same as a part of that of the whole cone; areas and unassigned sum to 1",
     OF_DOSE(NUMBER, dose_share)},
    {"mean_weight", NULL, "its dose by its volume, or the length of its streamlines, in the cone",
     OF_DOSE(NUMBER, mean_weight)},
    {"max_weight", NULL, "the largest weight in it: at voxels' centres, on rays or streamlines",
     OF_DOSE(NUMBER, max_weight)},
    TABLE_XYZ("max_", "where that is", OF_DOSE, max_at),
    {"above", NULL, "mm^3 of it, or streamlines of a bundle, where the weight is at the level or above",
     OF_DOSE(NUMBER, above)},
    {"above_share", NULL, "that volume as a part of that in the whole cone", OF_DOSE(NUMBER, above_share)},
    {"value_dose", NULL, "integral of its value times the weight, of a pathway or an area of probabilities",
     OF_DOSE(NUMBER, value_dose)},
    {"contact_value", NULL,
     "value of the voxel at the contact, of a pathway, or probability there of an area of probabilities",
     OF_ROW(NUMBER, result.contact_value)},
};

static const struct report_column region_column = {"query", NULL, "the region", NAMED(get_query)};

static struct cell get_radius(const conus_report *report, const struct report_row *row)
{
    const struct report_query *query = &report->queries[row->query];
    return number_cell(query->is_point ? 0 : query->asked.ball);
}

/* Which point was asked; behind all others, so that no other column moves. */
static const struct report_column point_columns[] = {
    TABLE_XYZ("", "the point that was asked, or the apex", OF_QUERY, asked.cone.pose.world_from_device[12]),
    {"radius_mm", "mm", "radius of the ball around it that was asked; 0: what is at it", .get = get_radius,
     .home = HOME_QUERY},
};

static struct cell get_selected(const conus_report *report, const struct report_row *row)
{
    return integer_cell(report_is_selected(report, row));
}

static struct cell get_confirmed(const conus_report *report, const struct report_row *row)
{
    return integer_cell(report_is_confirmed(report, row));
}

static const struct report_column track_columns[] = {
    {"time_s", "s", "time of the step", OF_QUERY(TIME, step.time_s)},
    {"selected", NULL, "1 if it is what is selected at this step, else 0", .get = get_selected},
    {"confirmed", NULL, "1 if the trigger, pressed at this step, confirms it, else 0", .get = get_confirmed},
};

static const struct report_column share_columns[] = {
    {"angle_deg", "degree", "full opening angle of the cone", OF_QUERY(NUMBER, asked.cone.degrees)},
};

/* Plans: one row per pose, constraint, or constraint and depth. */

#define OF_POSE(kind, member) .type = COLUMN_##kind, .offset = offsetof(conus_planned, member), .home = HOME_POSE
#define OF_VERDICT(kind, member) .type = COLUMN_##kind, .offset = offsetof(conus_verdict, member), .home = HOME_VERDICT
#define OF_CONSTRAINT(kind, member)                                                                                    \
    .type = COLUMN_##kind, .offset = offsetof(struct report_constraint, member), .home = HOME_CONSTRAINT
#define OF_COMBINATION(kind, member)                                                                                   \
    .type = COLUMN_##kind, .offset = offsetof(conus_combination, member), .home = HOME_COMBINATION

static const conus_verdict *verdict_of(const struct report_row *row)
{
    return &row->planned.pose->verdicts[row->planned.constraint];
}

static const struct report_constraint *constraint_of(const conus_report *report, const struct report_row *row)
{
    return &report_plan_of(report, row)->constraints[row->planned.constraint];
}

static struct cell get_plan_rank(const conus_report *report, const struct report_row *row)
{
    uint64_t rank = report->needles.count ? 0 : row->planned.pose->rank;
    return rank ? integer_cell(rank) : no_cell();
}

/* The constraint by the name of its structure, or by its kind. */
static struct cell constraint_cell(const conus_report *report, const struct report_row *row, size_t index)
{
    const struct report_constraint *constraint =
        &report_plan_of(report, row)->constraints[index < SIZE_MAX ? index : 0];
    return index < SIZE_MAX ? text_cell(constraint->name ? constraint->name : constraint->kind) : no_cell();
}

static struct cell get_broken(const conus_report *report, const struct report_row *row)
{
    return constraint_cell(report, row, row->planned.pose->broken);
}

static struct cell get_leeway_of(const conus_report *report, const struct report_row *row)
{
    return constraint_cell(report, row, row->planned.pose->leeway_of);
}

static struct cell get_clearance_of(const conus_report *report, const struct report_row *row)
{
    return constraint_cell(report, row, row->planned.pose->clearance_of);
}

static struct cell get_clearance_at(const conus_report *report, const struct report_row *row)
{
    (void)report;
    const conus_planned *pose = row->planned.pose;
    return pose->clearance_of < SIZE_MAX ? number_cell(pose->verdicts[pose->clearance_of].depth) : no_cell();
}

/* Of several needles together: the combination, of which each row is a needle. */

static const conus_combination *combination_of(const conus_report *report, const struct report_row *row)
{
    return report->needles.combinations[row->planned.combination];
}

static struct cell get_combination(const conus_report *report, const struct report_row *row)
{
    return integer_cell(combination_of(report, row)->feasible ? row->planned.combination + 1 : 0);
}

static struct cell get_proven(const conus_report *report, const struct report_row *row)
{
    const conus_combination *combination = combination_of(report, row);
    return combination->feasible ? integer_cell(combination->proven) : no_cell();
}

static struct cell get_contacts(const conus_report *report, const struct report_row *row)
{
    return integer_cell(combination_of(report, row)->contacts);
}

static struct cell get_needle(const conus_report *report, const struct report_row *row)
{
    return text_cell(report->needles.at[row->planned.needle]->name);
}

static double angle_of(const conus_report *report, const struct report_row *row, bool is_arc)
{
    double arc;
    double slider;
    arc_angles(&arc, &slider, &report->frame, row->planned.pose->pose.world_from_device + 8);
    return is_arc ? remainder(arc + report->needles.asked->pitch, 360) : slider;
}

static struct cell get_arc(const conus_report *report, const struct report_row *row)
{
    return number_cell(angle_of(report, row, true));
}

static struct cell get_slider(const conus_report *report, const struct report_row *row)
{
    return number_cell(angle_of(report, row, false));
}

static struct cell get_needle_row(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return integer_cell(row->planned.question + 1);
}

static const struct report_column needle_columns[] = {
    {"combination", NULL, "number of the combination, from 1; 0 of one that breaks something", .get = get_combination},
    {"proven", NULL, "1 if it is proven that no combination that may stand there is better, else 0", .get = get_proven},
    {"all_leeway_mm", "mm", "the least leeway of all needles and pairs", OF_COMBINATION(NUMBER, leeway)},
    {"all_leeway_of", NULL, "the needle that has it, or both of the pair", OF_COMBINATION(TEXT, leeway_of)},
    {"all_bound", "mm", "no combination that may stand there has a larger least leeway", OF_COMBINATION(NUMBER, bound)},
    {"all_sum_mm", "mm", "sum of the needles' leeways", OF_COMBINATION(NUMBER, sum)},
    {"all_depth_mm", "mm", "sum of the needles' depths", OF_COMBINATION(NUMBER, depth)},
    {"all_contacts", NULL, "contacts of all needles that are in any --cover", .get = get_contacts, .only = ONLY_COVERS},
    {"needle", NULL, "name of the needle", NAMED(get_needle)},
    {"row", NULL, "number of the row of the table that it answers, from 1", .get = get_needle_row},
    {"arc_deg", "degree", "angle of its arc on the rig of --arcs", .get = get_arc, .only = ONLY_ARCS},
    {"slider_deg", "degree", "its angle along that arc", .get = get_slider, .only = ONLY_ARCS},
};

static const struct report_column plan_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", NAMED(get_query)},
    {"rank", NULL, "1 is the best of those that break nothing", .get = get_plan_rank},
    {"feasible", NULL, "1 if the pose breaks no constraint, else 0", OF_POSE(FLAG, feasible)},
    {"broken", NULL, "the first constraint that it breaks, by the name of its structure, else by its kind",
     NAMED(get_broken)},
    {"entry", NULL, "number of the entry of a candidate, from 1", OF_POSE(LARGE_RANK, entry)},
    {"target", NULL, "number of its target, from 1", OF_POSE(LARGE_RANK, target)},
    TABLE_XYZ("", "position of the device, the apex", OF_POSE, pose.world_from_device[12]),
    {"dx", NULL, "direction of its axis, of length 1, x", OF_ROW(NUMBER, planned.axis[0])},
    {"dy", NULL, "the same, y", OF_ROW(NUMBER, planned.axis[1])},
    {"dz", NULL, "the same, z", OF_ROW(NUMBER, planned.axis[2])},
    TABLE_XYZ("tip_", "far end of the needle", OF_ROW, planned.at),
    {"far_mm", "mm", "how far that is from the apex", OF_POSE(NUMBER, far)},
    {"entry_angle_deg", "degree", "between the axis and the inward normal at the entry", OF_POSE(NUMBER, entry_angle)},
    {"leeway_mm", "mm", "no point of the axis may be off by so much that a constraint breaks, as far as is known",
     OF_POSE(NUMBER, leeway)},
    {"leeway_of", NULL, "the constraint that has the least leeway, named as broken", NAMED(get_leeway_of)},
    {"slack_mm", "mm", "least clearance from what is avoided, its margin taken off", OF_POSE(NUMBER, slack)},
    {"clearance_mm", "mm", "least clearance from what is avoided, the radius taken off", OF_POSE(NUMBER, clearance)},
    {"clearance_of", NULL, "what that is", NAMED(get_clearance_of)},
    {"clearance_at_mm", "mm", "where the axis is nearest to it, from the apex", .get = get_clearance_at},
    {"score", NULL, "value of the formula that was given", OF_POSE(NUMBER, score)},
    {"p_ok", NULL, "probability that it breaks no constraint, of a pose with errors", OF_POSE(NUMBER, p_ok)},
};

static struct cell get_number(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return integer_cell(row->planned.constraint + 1);
}

static struct cell get_limit(const conus_report *report, const struct report_row *row)
{
    const conus_constraint *asked = constraint_of(report, row)->asked;
    double value = verdict_of(row)->value;
    bool has_upper = asked->kind == CONUS_CONSTRAINT_LENGTH || asked->kind >= CONUS_CONSTRAINT_ARC;
    bool is_upper = has_upper && asked->most - value < value - asked->limit;
    return number_cell(is_upper ? asked->most : asked->limit);
}

static struct cell get_constraint_index(const conus_report *report, const struct report_row *row)
{
    return integer_cell(constraint_of(report, row)->index);
}

#define CONSTRAINT_KIND                                                                                                \
    {                                                                                                                  \
        "kind", NULL, "reach, avoid, length, lean, apart, first, angle, arc or slider", OF_CONSTRAINT(TEXT, kind)      \
    }
#define CONSTRAINT_INDEX                                                                                               \
    {                                                                                                                  \
        "index", NULL, "its number among those of its kind, from 1", NAMED(get_constraint_index)                       \
    }
#define CONSTRAINT_NAME                                                                                                \
    {                                                                                                                  \
        "name", NULL, "names of the objects of its structure", OF_CONSTRAINT(TEXT, name)                               \
    }

static const struct report_column constraint_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", NAMED(get_query)},
    {"constraint", NULL, "number of the constraint on the command line, from 1", NAMED(get_number)},
    CONSTRAINT_KIND,
    CONSTRAINT_INDEX,
    CONSTRAINT_NAME,
    {"value", NULL, "what was measured, mm or degrees, or as the constraint says", OF_VERDICT(NUMBER, value)},
    {"limit", NULL, "what it is compared with; of a length the end that is nearer", .get = get_limit},
    {"slack", NULL, "by how much the constraint holds; negative where it breaks", OF_VERDICT(NUMBER, slack)},
    {"holds", NULL, "1 if it holds, else 0", OF_VERDICT(FLAG, holds)},
    {"leeway_mm", "mm", "no point of the axis may be off by so much that it breaks", OF_VERDICT(NUMBER, leeway)},
    {"p_holds", NULL, "probability that it holds, of a pose with errors", OF_VERDICT(NUMBER, p)},
    {"shank", NULL, "number of the parallel needle that has these values, from 1", OF_VERDICT(COUNT, shank)},
};

static struct cell get_profile_clearance(const conus_report *report, const struct report_row *row)
{
    return number_cell(row->planned.distance - report->selector.radius);
}

static const struct report_column profile_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", NAMED(get_query)},
    {"order", NULL, "number of the depth, 1 is nearest to the apex", OF_ROW(LARGE_COUNT, planned.order)},
    {"depth_mm", "mm", "depth of a point of the axis, from the apex", OF_ROW(NUMBER, planned.depth)},
    TABLE_XYZ("", "where that point is", OF_ROW, planned.at),
    CONSTRAINT_KIND,
    CONSTRAINT_INDEX,
    CONSTRAINT_NAME,
    {"distance_mm", "mm", "how far that point is from the structure", OF_ROW(NUMBER, planned.distance)},
    {"clearance_mm", "mm", "the same, the radius taken off", .get = get_profile_clearance},
};

static bool is_turn(const struct report_row *row)
{
    return row->planned.tolerance.freedom >= CONUS_FREEDOM_PITCH;
}

/* Shifts by what the space calls its axes. */
static struct cell get_freedom(const conus_report *report, const struct report_row *row)
{
    static const char *const names[] = {"x", "y", "z", "depth", "side", "up", "pitch", "yaw", "azimuth", "elevation"};
    static const char *const axes[][3] = {
        [CONUS_SPACE_CCF] = {"ap", "dv", "ml"}, [CONUS_SPACE_BREGMA] = {"ap", "ml", "dv"}};
    conus_freedom freedom = row->planned.tolerance.freedom;
    bool has_axes = freedom <= CONUS_FREEDOM_Z && report->frame.space >= CONUS_SPACE_CCF;
    return text_cell(has_axes ? axes[report->frame.space][freedom] : names[freedom]);
}

static struct cell get_side(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return text_cell(row->planned.tolerance.negative ? "-" : "+");
}

static struct cell get_unit(const conus_report *report, const struct report_row *row)
{
    (void)report;
    return text_cell(is_turn(row) ? "degree" : "mm");
}

static struct cell get_breaks(const conus_report *report, const struct report_row *row)
{
    return constraint_cell(report, row, row->planned.tolerance.constraint);
}

static struct cell get_broken_object(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = conus_atlas_object(report->atlas, row->planned.tolerance.object);
    return object ? text_cell(object->name) : no_cell();
}

static struct cell get_method(const conus_report *report, const struct report_row *row)
{
    static const char *const names[] = {"exact", "sampled", "graze"};
    (void)report;
    return text_cell(names[row->planned.tolerance.method]);
}

static const struct report_column tolerance_columns[] = {
    {"query", NULL, "query_id of the pose, else its number from 1", NAMED(get_query)},
    {"freedom", NULL, "the degree of freedom: shift along an axis of the space or the device, depth, or turn",
     NAMED(get_freedom)},
    {"side", NULL, "+ or -, to which side", NAMED(get_side)},
    {"unit", NULL, "of the next two: mm or degree", NAMED(get_unit)},
    {"holds_to", NULL, "no constraint breaks up to here; proven, if the method is exact or graze",
     OF_ROW(NUMBER, planned.tolerance.holds_to)},
    {"fails_at", NULL, "here one breaks; n/a where none does up to 20 mm or 30 degrees",
     OF_ROW(NUMBER, planned.tolerance.fails_at)},
    {"breaks", NULL, "the constraint that breaks there, by the name of its structure, else by its kind",
     NAMED(get_breaks)},
    {"object", NULL, "what is nearest there, of a structure to be avoided, or is first on the axis",
     NAMED(get_broken_object)},
    {"depth_mm", "mm", "where on the axis that is, or where what is reached begins, from the apex",
     OF_ROW(NUMBER, planned.tolerance.depth)},
    TABLE_XYZ("", "where in space", OF_ROW, planned.tolerance.at),
    {"method", NULL, "exact, sampled, or graze where between both numbers something only just does not break",
     NAMED(get_method)},
};

/* Summaries: one row per answer, with the best, the next, and by how much it is behind. */

static const char *const summary_common[] = {"query", "kind", "index", "name", "share", "score", "distance_mm"};

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
    return object ? text_cell(object->name) : no_cell();
}

static struct cell get_runner_up_index(const conus_report *report, const struct report_row *row)
{
    const conus_object *object = runner_up(report, row);
    return object ? integer_cell(object->label) : no_cell();
}

static struct cell get_runner_up_share(const conus_report *report, const struct report_row *row)
{
    return number_cell(runner_up(report, row) ? next_row(report, row)->result.share : NAN);
}

static struct cell get_score_margin(const conus_report *report, const struct report_row *row)
{
    return number_cell(runner_up(report, row) ? row->result.score - next_row(report, row)->result.score : NAN);
}

static struct cell get_unassigned(const conus_report *report, const struct report_row *row)
{
    while (next_row(report, row) != row) {
        row++;
    }
    return number_cell(row->result.object ? NAN : row->result.share);
}

static struct cell get_error(const conus_report *report, const struct report_row *row)
{
    return text_cell(report->queries[row->query].error);
}

static const struct report_column summary_columns[] = {
    {"runner_up", NULL, "name of the area, pathway or bundle with the second best score", NAMED(get_runner_up)},
    {"runner_up_index", NULL, "its index", NAMED(get_runner_up_index)},
    {"runner_up_share", NULL, "its share", .get = get_runner_up_share},
    {"margin", NULL, "score of the best less that of the runner-up", .get = get_score_margin},
    {"unassigned_share", NULL, "share that hits nothing", .get = get_unassigned},
    {"error", NULL, "why there is no answer; then kind is error, and all else is missing", NAMED(get_error)},
};

/* The columns added to a table of electrodes. */
static const struct report_column electrode_columns[] = {
    {"area", NULL, "name of the object with the best score at the contact, or unassigned", NAMED(get_name)},
    {"area_index", NULL, "the atlas's own label of it", NAMED(get_index)},
    {"area_share", NULL, "its part of the ball around the contact, or of the cone", OF_ROW(NUMBER, result.share)},
    {"area_distance_mm", "mm", "how far it is from the contact", OF_ROW(NUMBER, result.distance)},
    {"runner_up", NULL, "name of the area, pathway or bundle with the second best score", NAMED(get_runner_up)},
    {"runner_up_share", NULL, "its share", .get = get_runner_up_share},
    {"area_error", NULL, "why there is no answer", NAMED(get_error)},
};

static struct cell get_channel(const conus_report *report, const struct report_row *row)
{
    int64_t channel = report->queries[row->query].contact->channel;
    return channel >= 0 ? integer_cell((uint64_t)channel) : number_cell(channel == -1 ? -1 : NAN);
}

static struct cell get_hemisphere(const conus_report *report, const struct report_row *row)
{
    return text_cell(report_side(report, row->query));
}

static struct cell get_location(const conus_report *report, const struct report_row *row)
{
    return text_cell(report_location(report, report_area(report, row->query)));
}

static struct cell get_location_id(const conus_report *report, const struct report_row *row)
{
    return text_cell(report_location_id(report, report_area(report, row->query)));
}

static struct cell get_localization(const conus_report *report, const struct report_row *row)
{
    (void)row;
    return text_cell(report_localization(report));
}

#define OF_CONTACT(kind, member)                                                                                       \
    .type = COLUMN_##kind, .offset = offsetof(conus_probe_contact, member), .home = HOME_CONTACT

static struct cell get_probe(const conus_report *report, const struct report_row *row)
{
    const struct report_query *query = &report->queries[row->query];
    return text_cell(query->probe ? query->probe : query->contact->probe);
}

/* The columns of answers at the contacts of probes. */
static const struct report_column probe_columns[] = {
    {"probe", NULL, "the probe of the contact, by its place in its file", NAMED(get_probe)},
    {"shank_id", NULL, "shank_ids of the contact", OF_CONTACT(TEXT, shank)},
    {"channel", NULL, "device_channel_indices of the contact, from 0; -1 = not wired", .get = get_channel},
};

/* Those of electrodes.tsv in BEP032. */
static const struct report_column bep032_columns[] = {
    {"name", NULL, "name of the electrode, that of no other", NAMED(get_query)},
    {"probe_name", NULL, "name of its probe in probes.tsv", OF_CONTACT(TEXT, probe)},
    {"x", "um", "position on the probe, as ProbeInterface has it, across the shank", OF_CONTACT(NUMBER, position[0])},
    {"y", "um", "the same, along the shank, towards its base", OF_CONTACT(NUMBER, position[1])},
    {"z", "um", "the same, off the plane of the shanks; missing of a probe in two dimensions",
     OF_CONTACT(NUMBER, position[2])},
    {"hemisphere", NULL, "L or R", NAMED(get_hemisphere)},
    {"shank_id", NULL, "its shank", OF_CONTACT(TEXT, shank)},
    {"anatomical_location", NULL, "the area of the atlas that holds the centre of the contact", NAMED(get_location)},
    {"anatomical_location_id", NULL, "its id; MBA: the Allen Mouse Brain Atlas", NAMED(get_location_id)},
    {"localization_method", NULL, "how it was found", NAMED(get_localization)},
};

/* Its positions where they are those in a brain. */
static const struct report_column placed_columns[] = {
    TABLE_XYZ("", "position in the space that coordsystem.json describes", OF_QUERY,
              asked.cone.pose.world_from_device[12]),
};

/* The numbers in the list of voxels (report_voxels.c). */
static const struct report_column voxel_columns[] = {{.name = "x"}, {.name = "y"}, {.name = "z"}, {.name = "value"}};

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])
#define ALL_OF(array)                                                                                                  \
    {                                                                                                                  \
        array, COUNT_OF(array)                                                                                         \
    }

static void list_column(struct report_columns *out, const struct report_column *column)
{
    assert(out->count < REPORT_COLUMN_LIMIT);
    out->at[out->count++] = column;
}

/* Whether the atlas of the report, or of one that is joined to it, has bundles. */
static bool has_bundles(const conus_report *report)
{
    while (report && !atlas_has_bundles(report->atlas)) {
        report = report->next;
    }
    return report;
}

/* Which of enum column_only a report has. */
static unsigned columns_there(const conus_report *report)
{
    const bool has_weight = report->weight.form;
    const struct report_needles *needles = &report->needles;
    return (report->selector.layers ? ONLY_LAYERS : 0u) | (report->atlas->is_moved ? ONLY_MOVED : 0u) |
           (has_weight ? ONLY_WEIGHT : 0u) | (report->prior.power > 0 ? ONLY_POSTERIOR : 0u) |
           (has_weight && (report->selector.layers || report->options.points) ? ONLY_DOSES : 0u) |
           (has_bundles(report) ? ONLY_BUNDLES : 0u) |
           (needles->count && needles->asked->cover_count ? ONLY_COVERS : 0u) |
           (needles->count && needles->asked->arcs > 0 ? ONLY_ARCS : 0u);
}

static void list_table(struct report_columns *out, const conus_report *report, const struct report_column *table,
                       size_t count)
{
    const unsigned there = columns_there(report);
    for (size_t i = 0; i < count; i++) {
        if (!(table[i].only & ~there)) {
            list_column(out, &table[i]);
        }
    }
}

/* The columns of answers that have these names. */
static void list_named(struct report_columns *out, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct report_column *column = answer_columns;
        while (strcmp(column->name, names[i]) != 0) {
            column++;
        }
        list_column(out, column);
    }
}

/* Of which contact an answer is, and of which point. */
static void list_asked(struct report_columns *out, const conus_report *report)
{
    if (report->options.probe) {
        list_table(out, report, probe_columns, COUNT_OF(probe_columns));
    }
    if (report->options.points) {
        list_table(out, report, point_columns, COUNT_OF(point_columns) - !report->options.radii);
    }
}

static void list_answers(struct report_columns *out, const conus_report *report)
{
    list_table(out, report, answer_columns, COUNT_OF(answer_columns));
    if (report->options.tracker) {
        list_table(out, report, track_columns, COUNT_OF(track_columns));
    }
    list_asked(out, report);
}

static void list_bep032(struct report_columns *out, const conus_report *report)
{
    enum { X = 2 }; /* its place in the table */
    list_table(out, report, bep032_columns, COUNT_OF(bep032_columns));
    for (size_t i = 0; report->options.placed && i < COUNT_OF(placed_columns); i++) {
        out->at[X + i] = &placed_columns[i];
    }
}

/* Makes `column` the one at `place`, unless it is NULL. Returns whether it is there. */
static bool insert_column(struct report_columns *out, size_t place, const struct report_column *column)
{
    if (column) {
        list_column(out, column);
        memmove(&out->at[place + 1], &out->at[place], (out->count - 1 - place) * sizeof(struct report_column *));
        out->at[place] = column;
    }
    return column;
}

const struct table_fields *report_fields(enum report_rows rows)
{
    static const struct table_fields *const studies[] = {
        [ROWS_ADMISSIONS] = &sweep_fields,        [ROWS_CHANCES] = &jitter_fields,
        [ROWS_CONNECTIONS] = &connection_fields,  [ROWS_COVERAGES] = &overlap_fields,
        [ROWS_CLUSTERS] = &clusters_fields,       [ROWS_SEGMENTS] = &segment_fields,
        [ROWS_CLEARANCES] = &clearance_fields,    [ROWS_PAIRS] = &pair_fields,
        [ROWS_CALIBRATION] = &calibration_fields, [ROWS_RELIABILITY] = &reliability_fields,
        [ROWS_POSITIONS] = &position_fields};
    return (size_t)rows < COUNT_OF(studies) ? studies[rows] : NULL;
}

/* Whether some row has a number there. */
static bool is_worth_a_column(const conus_report *report, const struct report_column *column)
{
    for (; report; report = report->next) {
        for (size_t i = 0; i < report->row_count; i++) {
            const struct report_row *row = &report->rows[i];
            if (!report->queries[row->query].error && report_cell(report, column, row).number > 0) {
                return true;
            }
        }
    }
    return false;
}

/* The columns of tables, behind the question's. */
static void list_fields(struct report_columns *out, const conus_report *report)
{
    if (!report_has_no_queries(report)) {
        list_column(out, report->kind == ROWS_CLUSTERS ? &region_column : &answer_columns[0]);
    }
    for (size_t i = 0; i < report->field_count; i++) {
        if (!report->fields[i].unless_zeros || is_worth_a_column(report, &report->fields[i])) {
            list_column(out, &report->fields[i]);
        }
    }
}

void report_list_columns(struct report_columns *out, const conus_report *report)
{
    out->count = 0;
    switch (report->kind) {
    case ROWS_ANSWERS:
        if (report->as == REPORT_BIDS) {
            list_table(out, report, electrode_columns, COUNT_OF(electrode_columns));
        } else if (report->as == REPORT_BEP032) {
            list_bep032(out, report);
        } else {
            list_answers(out, report);
        }
        break;
    case ROWS_SUMMARIES:
        list_named(out, summary_common, COUNT_OF(summary_common));
        list_table(out, report, summary_columns, COUNT_OF(summary_columns));
        list_asked(out, report);
        break;
    case ROWS_SHARES:
        list_answers(out, report);
        list_table(out, report, share_columns, COUNT_OF(share_columns));
        break;
    case ROWS_NEEDLES:
        list_table(out, report, needle_columns, COUNT_OF(needle_columns));
        list_table(out, report, plan_columns, COUNT_OF(plan_columns));
        list_table(out, report, report->needles.columns, report->needles.column_count);
        break;
    case ROWS_PLAN:
        list_table(out, report, plan_columns, COUNT_OF(plan_columns));
        list_table(out, report, report->plan.columns, report->plan.column_count);
        break;
    case ROWS_CONSTRAINTS:
        list_table(out, report, constraint_columns, COUNT_OF(constraint_columns));
        break;
    case ROWS_PROFILE:
        list_table(out, report, profile_columns, COUNT_OF(profile_columns));
        break;
    case ROWS_TOLERANCE:
        list_table(out, report, tolerance_columns, COUNT_OF(tolerance_columns));
        break;
    default: /* of tables */
        list_fields(out, report);
        break;
    }
    const conus_row_marks *marks = report_marks(report);
    size_t place = 1;
    place += insert_column(out, place, report->name ? &atlas_column : NULL);
    place += insert_column(out, place, marks && marks->has_number ? &row_column : NULL);
    (void)insert_column(out, place, marks && marks->has_time ? &time_column : NULL);
    if (marks && report->kept) {
        list_table(out, report, report->kept, marks->count);
    }
}

/* Whether a column of this name holds a number of a constraint: "reach1_mm", "p_reach1". */
static bool is_of_constraint(const char *name)
{
    name += strncmp(name, "p_", 2) == 0 ? 2 : 0;
    static const char *const kinds[] = {"reach", "avoid", "length", "lean", "apart", "first", "angle"};
    bool is = false;
    for (size_t i = 0; i < COUNT_OF(kinds); i++) {
        size_t length = strlen(kinds[i]);
        is = is || (strncmp(name, kinds[i], length) == 0 && name[length] >= '1' && name[length] <= '9');
    }
    return is;
}

bool conus_column_is_number(const char *name)
{
    static const struct {
        const struct report_column *columns;
        size_t count;
    } tables[] = {
        ALL_OF(answer_columns),    ALL_OF(track_columns),     ALL_OF(share_columns), ALL_OF(summary_columns),
        ALL_OF(electrode_columns), ALL_OF(voxel_columns),     ALL_OF(plan_columns),  ALL_OF(constraint_columns),
        ALL_OF(profile_columns),   ALL_OF(tolerance_columns), ALL_OF(probe_columns), ALL_OF(bep032_columns),
        ALL_OF(needle_columns),    {&row_column, 1}};
    for (size_t i = 0; i < COUNT_OF(tables); i++) {
        for (size_t k = 0; k < tables[i].count; k++) {
            if (strcmp(tables[i].columns[k].name, name) == 0) {
                enum column_type type = tables[i].columns[k].type;
                return type != COLUMN_NAME && type != COLUMN_TEXT;
            }
        }
    }
    bool is_number = is_of_constraint(name);
    for (enum report_rows rows = ROWS_ANSWERS; rows <= ROWS_POSITIONS; rows++) {
        const struct table_fields *fields = report_fields(rows);
        for (size_t i = 0; fields && i < fields->count; i++) {
            enum column_type type = fields->at[i].type;
            is_number = is_number || (strcmp(fields->at[i].name, name) == 0 && type != COLUMN_NAME &&
                                      type != COLUMN_LABEL && type != COLUMN_TEXT);
        }
    }
    return is_number;
}

/* What the offsets of columns are in. */
static const void *home_of(const conus_report *report, enum column_home home, const struct report_row *row)
{
    switch (home) {
    case HOME_QUERY:
    case HOME_MARKS:
        return &report->queries[row->query];
    case HOME_CONTACT:
        return report->queries[row->query].contact;
    case HOME_POSE:
        return row->planned.pose;
    case HOME_VERDICTS:
        return row->planned.pose->verdicts;
    case HOME_VERDICT:
        return verdict_of(row);
    case HOME_CONSTRAINT:
        return constraint_of(report, row);
    case HOME_COMBINATION:
        return combination_of(report, row);
    default:
        return row;
    }
}

struct cell report_cell(const conus_report *report, const struct report_column *column, const struct report_row *row)
{
    const struct report_query *query = &report->queries[row->query];
    if (column->home == HOME_KEPT) {
        return text_cell(query->kept[column->offset]);
    }
    if (!query->error || column->home == HOME_MARKS) {
        if (column->needs && column->needs & ~report_needs_met(report, row)) {
            return no_cell();
        }
        if (column->get) {
            return column->get(report, row);
        }
        if (column->home == HOME_NEEDLE) {
            const struct report_question *question = &report->needles.questions[row->planned.question];
            size_t place = question->places[column->offset];
            return place < SIZE_MAX ? report_cell(report, &question->plan.columns[place], row) : no_cell();
        }
        if (column->home == HOME_TABLE) {
            return table_cell(&table_columns(row->of_table.table)[column->offset], row->of_table.index);
        }
        const char *home = home_of(report, column->home, row);
        return cell_at(column->type, home + column->offset, report->atlas, &report->frame);
    }
    const char *reason = report->kind == ROWS_SUMMARIES     ? "error"
                         : report->kind == ROWS_CONNECTIONS ? "bundle"
                         : report->as == REPORT_BIDS        ? "area_error"
                                                            : "name";
    const char *text = column->get == get_query        ? query->id
                       : column == &atlas_column       ? report->name
                       : !strcmp(column->name, "kind") ? "error"
                       : !strcmp(column->name, reason) ? query->error
                                                       : NULL;
    return text_cell(text);
}
