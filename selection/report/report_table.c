/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of answers for people, aligned, with units; and what all tables for people have in common. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

void table_write_atlas(struct buffer *out, const conus_report *report)
{
    if (report->name) {
        buffer_format(out, "atlas %s\n", report->name);
    }
}

static void write_shape(struct buffer *out, const struct cone *cone)
{
    bool square = cone->aperture == CONUS_APERTURE_SQUARE;
    if (cone->radius > 0) {
        buffer_format(out, "%s %.4g mm", square ? "square rod of half width" : "cylinder of radius", cone->radius);
    } else {
        buffer_format(out, "%s of %.4g degrees", square ? "square pyramid" : "cone", cone->degrees);
        buffer_text(out, cone_is_wide(cone) ? ", rays spread evenly," : "");
    }
    if (cone_has_range(cone)) {
        buffer_format(out, ", %.4g to %.4g mm deep,", cone->range[0], cone->range[1]);
    }
}

void table_write_space(struct buffer *out, const conus_report *report)
{
    static const char *const places[] = {[CONUS_SPACE_RAS] = "",
                                         [CONUS_SPACE_LPS] = "",
                                         [CONUS_SPACE_CCF] = " in CCF",
                                         [CONUS_SPACE_BREGMA] = " from bregma"};
    char axes[TABLE_AXES_SIZE];
    conus_space space = report->frame.space;
    const char *letters = space == CONUS_SPACE_LPS ? "LPS" : "RAS";
    buffer_format(out, ", %s %s%s\n", space >= CONUS_SPACE_CCF ? table_axes(axes, report, "") + 1 : letters,
                  conus_space_unit(space), places[space]);
}

void table_write_axis(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    const double *m = query->asked.cone.pose.world_from_device;
    double origin[3] = {m[12], m[13], m[14]};
    double axis[3] = {-m[8], -m[9], -m[10]};
    report_point(report, origin);
    conus_frame_direction_from_world(axis, &report->frame, axis);
    int digits = table_digits(report);
    buffer_format(out, " from (%.*f, %.*f, %.*f) along (%.4f, %.4f, %.4f)", digits, origin[0], digits, origin[1],
                  digits, origin[2], axis[0], axis[1], axis[2]);
}

/* The query's id with the marks of its row: "LA1 (row 3, group left)". */
static void write_id(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    const conus_row_marks *marks = report_marks(report);
    char time[TEXT_NUMBER_SIZE];
    buffer_text(out, query->id);
    const char *before = " (";
    if (marks && marks->has_number) {
        buffer_format(out, "%srow %llu", before, (unsigned long long)query->number);
        before = ", ";
    }
    if (marks && marks->has_time && isfinite(query->time_s)) {
        buffer_format(out, "%s%s s", before, text_time(time, query->time_s));
        before = ", ";
    }
    for (size_t i = 0; marks && query->kept && i < marks->count; i++) {
        if (query->kept[i][0]) {
            buffer_format(out, "%s%s %s", before, report->kept[i].name, query->kept[i]);
            before = ", ";
        }
    }
    buffer_text(out, before[0] == ',' ? ")" : "");
}

void table_write_id(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    buffer_text(out, "query ");
    write_id(out, report, query);
    buffer_text(out, ": ");
}

void table_write_query(struct buffer *out, const conus_report *report, const struct report_query *query)
{
    size_t count = report->query_count;
    bool is_one_pose = report->kind == ROWS_SHARES && report_is_same_pose(report, 0, count - 1);
    if (count > 1 && !is_one_pose) {
        table_write_id(out, report, query);
    }
    if (query->asked.ball > 0) {
        double middle[3];
        memcpy(middle, query->asked.cone.pose.world_from_device + 12, sizeof middle);
        report_point(report, middle);
        int digits = table_digits(report);
        if (query->is_point || query->asked.ball <= CONUS_POINT_RADIUS) {
            buffer_text(out, "point (");
        } else {
            buffer_format(out, "ball of radius %.4g mm around (", query->asked.ball);
        }
        buffer_format(out, "%.*f, %.*f, %.*f)", digits, middle[0], digits, middle[1], digits, middle[2]);
    } else {
        if (report->kind == ROWS_SHARES) {
            buffer_text(out, query->asked.cone.aperture == CONUS_APERTURE_SQUARE ? "square pyramids" : "cones");
        } else {
            write_shape(out, &query->asked.cone);
        }
        table_write_axis(out, report, query);
    }
    table_write_space(out, report);
}

/* The columns of answers for people. */

#define AT(member) .offset = offsetof(conus_result, member), .size = sizeof((conus_result *)0)->member
#define PERCENT .after = " %", .none = "-  "
#define OF_OBJECTS .none = "-", .in = IN_OBJECTS

#define FIRST_COLUMNS                                                                                                  \
    {"rank", "", LOOK_COUNT, 4, AT(rank), .in = IN_OBJECTS}, {"name", "", LOOK_NAME, .none = TABLE_NOTHING},           \
    {                                                                                                                  \
        "label", "", LOOK_LABEL, .width = 10                                                                           \
    }
#define HIT_COLUMNS(below_pixels)                                                                                      \
    {"share", "of cone", LOOK_SHARE, 8, AT(share), .after = " %"},                                                     \
        {"pixels", below_pixels, LOOK_COUNT, 6, AT(pixels)},                                                           \
        {"weight", "of all", LOOK_PERCENT, 8, AT(weight), .digits = 1, PERCENT, .with = WITH_WEIGHT},                  \
        {"error", "%", LOOK_PERCENT, 5, AT(weight_error), .digits = 1, .none = "-", .with = WITH_WEIGHT},              \
    {                                                                                                                  \
        "posterior", "", LOOK_PERCENT, 9, AT(posterior), .digits = 1, PERCENT, .with = WITH_POSTERIOR,                 \
                                                         .in = IN_OBJECTS                                              \
    }
#define DOSE_COLUMNS                                                                                                   \
    {"dose", "of all", LOOK_PERCENT, 8, AT(dose_share), .digits = 1, PERCENT, .with = WITH_DOSES},                     \
        {"mean", "weight", LOOK_SHORT, 9, AT(mean_weight), .digits = 4, .none = "-", .with = WITH_DOSES},              \
    {                                                                                                                  \
        "above", "mm^3", LOOK_SHORT, 9, AT(above), .digits = 4, .none = "-", .with = WITH_DOSES                        \
    }
#define WHOLE_COLUMNS                                                                                                  \
    {"of whole", "area", LOOK_PERCENT, 8, AT(fraction), .digits = 2, PERCENT, .in = IN_OBJECTS},                       \
    {                                                                                                                  \
        "mean", "value", LOOK_FIXED, 9, AT(mean_value), .digits = 4, OF_OBJECTS, .with = WITH_MEANS                    \
    }
#define BUNDLE_COLUMNS(where)                                                                                          \
    {"streamlines", where, LOOK_STREAMLINES, 15, .with = WITH_BUNDLES, .in = IN_BUNDLES},                              \
    {                                                                                                                  \
        "length", "mm", LOOK_FIXED, 9, AT(length), .digits = 1, .none = "-", .with = WITH_BUNDLES, .in = IN_BUNDLES    \
    }

static const struct shown visible_shown[] = {
    FIRST_COLUMNS,
    HIT_COLUMNS(""),
    {"nearest", "mm", LOOK_FIXED, 9, AT(distance), .digits = 2, OF_OBJECTS},
    {"off axis", "degrees", LOOK_FIXED, 8, AT(offset), .digits = 2, OF_OBJECTS},
    {"contact", NULL, LOOK_POINT, 26, AT(contact), OF_OBJECTS},
    {0},
};

static const struct shown layers_shown[] = {
    FIRST_COLUMNS,
    HIT_COLUMNS("seen"),
    DOSE_COLUMNS,
    {"pixels", "pierced", LOOK_COUNT, 7, AT(pierced), .in = IN_OBJECTS},
    {"enters", "mm", LOOK_FIXED, 8, AT(entry), .digits = 2, OF_OBJECTS},
    {"leaves", "mm", LOOK_FIXED, 8, AT(exit), .digits = 2, OF_OBJECTS},
    {"inside", "mm", LOOK_FIXED, 7, AT(path), .digits = 2, OF_OBJECTS},
    {"volume", "mm^3", LOOK_VOLUME, 9, AT(volume), OF_OBJECTS},
    WHOLE_COLUMNS,
    BUNDLE_COLUMNS("in the cone"),
    {0},
};

static const struct shown ball_shown[] = {
    FIRST_COLUMNS,
    {"share", "of ball", LOOK_PERCENT, 8, AT(share), .digits = 2, PERCENT},
    DOSE_COLUMNS,
    {"voxels", "", LOOK_COUNT, 8, AT(voxels)},
    {"volume", "mm^3", LOOK_VOLUME, 9, AT(volume), .none = "-"},
    WHOLE_COLUMNS,
    {"distance", "mm", LOOK_FIXED, 8, AT(distance), .digits = 2, OF_OBJECTS},
    {"nearest point", NULL, LOOK_POINT, 26, AT(contact), OF_OBJECTS},
    BUNDLE_COLUMNS("in the ball"),
    {0},
};

static const struct shown point_shown[] = {
    FIRST_COLUMNS,
    {"distance", "mm", LOOK_FIXED, 8, AT(distance), .digits = 2, .none = "-"},
    {"nearest point", NULL, LOOK_POINT, 26, AT(contact), .none = "-"},
    {0},
};

enum form { FORM_VISIBLE, FORM_LAYERS, FORM_BALL, FORM_POINT, FORMS };

/* The value of a pathway, or a probability, at the point; ends the line. */
static void end_at_point(struct buffer *out, const conus_result *result)
{
    if (isfinite(result->contact_value)) {
        buffer_format(out, "  value %.4g", result->contact_value);
    }
    buffer_text(out, "\n");
}

void table_write_error(struct buffer *out, const conus_report *report, const struct report_query *query, bool more)
{
    table_write_id(out, report, query);
    buffer_format(out, "no answer: %s\n%s", query->error, more ? "\n" : "");
}

/* Says which objects the centre of a ball is in. */
static void write_here(struct buffer *out, const conus_report *report, size_t index)
{
    size_t count = 0;
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        const conus_result *result = &report->rows[row].result;
        if (result->object && result->distance == 0) {
            buffer_format(out, "%s%s", count++ ? ", " : "", conus_atlas_object(report->atlas, result->object)->name);
            if (isfinite(result->contact_value)) {
                buffer_format(out, " (value %.4g)", result->contact_value);
            }
        }
    }
    buffer_text(out, count                             ? "\n"
                     : report->queries[index].is_point ? "no area, pathway or bundle; the nearest:\n"
                                                       : "no area, pathway or bundle\n");
}

/* The answers of one atlas to query `index`. */
static void write_answers(struct buffer *out, const conus_report *report, size_t index,
                          const struct layout layouts[FORMS])
{
    const enum form form = report->queries[index].is_point         ? FORM_POINT
                           : report->queries[index].asked.ball > 0 ? FORM_BALL
                           : report->selector.layers               ? FORM_LAYERS
                                                                   : FORM_VISIBLE;
    table_write_atlas(out, report);
    if (report->queries[index].asked.ball > 0) {
        buffer_text(out, "at the point: ");
        write_here(out, report, index);
    }
    table_write_heading(out, report, &layouts[form], false);
    table_write_heading(out, report, &layouts[form], true);
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        table_write_row(out, report, &layouts[form], &report->rows[row]);
        if (form == FORM_POINT) {
            end_at_point(out, &report->rows[row].result);
        } else {
            buffer_text(out, "\n");
        }
    }
}

/* Whether all answers are of what is at contacts of probes. */
static bool is_of_contacts(const conus_report *report)
{
    bool all = report->query_count > 1;
    for (size_t i = 0; i < report->query_count && all; i++) {
        const struct report_query *query = &report->queries[i];
        all = query->contact && !query->error && query->asked.ball > 0 && query->asked.ball <= CONUS_POINT_RADIUS;
    }
    return all;
}

/* A line for contacts side by side on a shank at which is the same. */
static void write_contacts(struct buffer *out, const conus_report *report)
{
    char axes[TABLE_AXES_SIZE];
    struct buffer last = {0};
    size_t first = 0;
    int digits = table_digits(report);
    buffer_format(out, "%8s  %-28s  %26s  %s\n", "contacts", "from, to", table_axes(axes, report, "the first at"),
                  "what is at each");
    for (size_t i = 0; i <= report->query_count; i++) {
        const struct report_query *query = &report->queries[i < report->query_count ? i : 0];
        const struct report_query *begin = &report->queries[first];
        struct buffer here = {0};
        for (const conus_report *of = report; of && i < report->query_count; of = of->next) {
            buffer_format(&here, "%s%s%s", of == report ? "" : "; ", of->name ? of->name : "", of->name ? ": " : "");
            write_here(&here, of, i);
            here.size -= here.size > 0; /* its line's end */
        }
        out->failed = out->failed || here.failed;
        bool is_same = i && i < report->query_count && here.size == last.size &&
                       memcmp(here.data, last.data, here.size) == 0 && query->probe == begin->probe &&
                       query->contact->index == begin->contact->index &&
                       strcmp(query->contact->shank, begin->contact->shank) == 0;
        if (i && !is_same) {
            char names[64];
            double p[3];
            snprintf(names, sizeof names, "%.28s%s%.28s", begin->id, i > first + 1 ? ", " : "",
                     i > first + 1 ? report->queries[i - 1].id : "");
            memcpy(p, begin->asked.cone.pose.world_from_device + 12, sizeof p);
            report_point(report, p);
            buffer_format(out, "%8zu  ", i - first);
            table_write_name(out, names, 28);
            buffer_format(out, "  %*.*f %*.*f %*.*f  %.*s\n", 8, digits, p[0], 8, digits, p[1], 8, digits, p[2],
                          (int)last.size, last.data ? last.data : "");
            first = i;
        }
        buffer_finish(&last);
        last = here;
    }
    buffer_finish(&last);
    buffer_text(out, "TSV, CSV and JSON have each contact\n");
    table_write_sources(out, report);
}

/* Whether there are several answers, all of what is at a point. */
static bool is_of_points(const conus_report *report)
{
    bool all = report->query_count > 1;
    bool any = false;
    for (size_t i = 0; i < report->query_count && all; i++) {
        any = any || report->queries[i].is_point;
        all = report->queries[i].is_point || report->queries[i].error;
    }
    return all && any;
}

enum { WIDEST_ID = 40, WIDTH_OF_POINT = 26 };

static const char nearest[] = "nearest: "; /* before the name of an object that is not at the point */

/* Widths of the columns of a list of points. */
struct point_widths {
    int id, atlas, names;
    int gap; /* Before names; 0 where atlases have none. */
};

static int widest(int width, const char *text)
{
    const int other = table_width(text);
    return other > width ? other : width;
}

static struct point_widths find_widths(const conus_report *report)
{
    struct point_widths widths = {.id = table_width("point")};
    const size_t queries = report->query_count;
    bool has_near = false;
    for (const conus_report *of = report; of; of = of->next) {
        widths.atlas = of->name ? widest(widths.atlas, of->name) : 0;
        for (size_t row = 0; row < of->row_count; row++) {
            has_near = has_near || of->rows[row].result.distance > 0;
        }
    }
    for (size_t i = 0; i < queries; i++) {
        struct buffer id = {0};
        write_id(&id, report, &report->queries[i]);
        widths.id = widest(widths.id, id.data ? id.data : "");
        buffer_finish(&id);
    }
    widths.id = widths.id > WIDEST_ID ? WIDEST_ID : widths.id;
    widths.gap = widths.atlas ? 2 : 0;
    widths.names = table_name_width(report) + (has_near ? table_width(nearest) : 0);
    return widths;
}

/* What one atlas has at a point, or nearest to it: a line each. `id` and `at` stand in the first line of the point. */
static void write_at_point(struct buffer *out, const conus_report *report, size_t index,
                           const struct point_widths *widths, const char *id, const char *at)
{
    char label[TABLE_LABEL_SIZE], distance[32];
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        const conus_result *result = &report->rows[row].result;
        const char *before = result->distance > 0 ? nearest : "";
        table_write_name(out, id, widths->id);
        buffer_format(out, "  %*s  ", WIDTH_OF_POINT, at);
        table_write_name(out, report->name ? report->name : "", widths->atlas);
        buffer_format(out, "%*s%s", widths->gap, "", before);
        table_write_name(out, table_name(report, result->object), widths->names - table_width(before));
        snprintf(distance, sizeof distance, "%.2f", result->distance);
        buffer_format(out, "  %10s  %8s", table_label(label, report, result->object),
                      isfinite(result->distance) ? distance : "-");
        end_at_point(out, result);
        id = at = "";
    }
}

static void write_points(struct buffer *out, const conus_report *report)
{
    static const char form[] = "%-*s  %*s  %-*s%*s%-*s  %10s  %8s\n";
    char axes[TABLE_AXES_SIZE], at[96];
    const int digits = table_digits(report);
    const struct point_widths w = find_widths(report);
    buffer_format(out, form, w.id, "point", WIDTH_OF_POINT, table_axes(axes, report, "at"), w.atlas,
                  w.atlas ? "atlas" : "", w.gap, "", w.names, "what is at it", "label", "distance");
    buffer_format(out, form, w.id, "", WIDTH_OF_POINT, conus_space_unit(report->frame.space), w.atlas, "", w.gap, "",
                  w.names, "", "", "mm");
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        struct buffer text = {0};
        double p[3];
        memcpy(p, query->asked.cone.pose.world_from_device + 12, sizeof p);
        report_point(report, p);
        snprintf(at, sizeof at, "%8.*f %8.*f %8.*f", digits, p[0], digits, p[1], digits, p[2]);
        write_id(&text, report, query);
        out->failed = out->failed || text.failed;
        const char *id = text.data ? text.data : "";
        const size_t line = out->size;
        for (const conus_report *of = report; of && !query->error; of = of->next) {
            const bool is_first = out->size == line;
            write_at_point(out, of, i, &w, is_first ? id : "", is_first ? at : "");
        }
        if (out->size == line) {
            table_write_name(out, id, w.id);
            buffer_format(out, query->error ? "  no answer: %s\n" : "  %s  nothing\n",
                          query->error ? query->error : at);
        }
        buffer_finish(&text);
    }
    table_write_sources(out, report);
}

void report_write_table(struct buffer *out, const conus_report *report)
{
    if (is_of_contacts(report) || is_of_points(report)) {
        (is_of_contacts(report) ? write_contacts : write_points)(out, report);
        return;
    }
    const struct layout layouts[FORMS] = {table_lay_out(report, visible_shown), table_lay_out(report, layers_shown),
                                          table_lay_out(report, ball_shown), table_lay_out(report, point_shown)};
    for (size_t i = 0; i < report->query_count; i++) {
        if (report->queries[i].error) {
            table_write_error(out, report, &report->queries[i], i + 1 < report->query_count);
            continue;
        }
        table_write_query(out, report, &report->queries[i]);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answers(out, of, i, layouts);
        }
        const struct report_query *query = &report->queries[i];
        if (query->asked.ball > 0) {
            buffer_format(out, "ranked by %sdistance%s\n", query->is_point ? "" : "share, then ",
                          report->options.order && !query->is_point ? ", nearest first" : "");
        } else {
            buffer_format(out, "%u pixels in the cone (%u x %u buffer); ranked by %s%s; engine %s, %s\n",
                          query->cone_pixels, query->asked.cone.resolution, query->asked.cone.resolution, report->score,
                          report->options.order ? ", in order of depth" : "", report->engine,
                          report->selector.sampling == CONUS_SAMPLING_SLICES ? "slices" : "exact");
        }
        buffer_text(out, i + 1 < report->query_count ? "\n" : "");
    }
    table_write_sources(out, report);
}
