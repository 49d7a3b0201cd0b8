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

enum { NAME_LIMIT = 48 };

/* Columns on a terminal of a UTF-8 text, one per code point (good enough for area names). */
static int width_of(const char *text)
{
    int width = 0;
    for (; *text; text++) {
        width += ((unsigned char)*text & 0xc0) != 0x80;
    }
    return width;
}

const char *table_name(const conus_report *report, uint32_t object)
{
    const conus_object *named = conus_atlas_object(report->atlas, object);
    return named ? named->name : TABLE_NOTHING;
}

const char *table_label(char out[TABLE_LABEL_SIZE], const conus_report *report, uint32_t object)
{
    const conus_object *labelled = conus_atlas_object(report->atlas, object);
    out[0] = '\0';
    if (labelled) {
        const char *word = report->prefixes[object];
        snprintf(out, TABLE_LABEL_SIZE, "%s%s%u", word, word[0] ? " " : "", labelled->label);
    }
    return out;
}

int table_wider(int width, const char *name)
{
    int wanted = width_of(name);
    wanted = wanted < NAME_LIMIT ? wanted : NAME_LIMIT;
    return wanted > width ? wanted : width;
}

double report_number(const struct report_row *row, const char *column)
{
    return conus_table_numbers(row->of_table.table, column)[row->of_table.index];
}

const char *report_text(const struct report_row *row, const char *column)
{
    const char *text = conus_table_texts(row->of_table.table, column)[row->of_table.index];
    return text ? text : "";
}

int table_name_width(const conus_report *report)
{
    int width = 12;
    for (; report; report = report->next) {
        for (size_t i = 0; i < report->row_count; i++) {
            width = table_wider(width, table_name(report, report->rows[i].result.object));
        }
    }
    return width;
}

void table_write_atlas(struct buffer *out, const conus_report *report)
{
    if (report->name) {
        buffer_format(out, "atlas %s\n", report->name);
    }
}

void table_write_name(struct buffer *out, const char *name, int width)
{
    int columns = width_of(name);
    int keep = columns > width ? width - 3 : columns;
    const char *end = name;
    for (int kept = 0; *end; end++) {
        if (((unsigned char)*end & 0xc0) != 0x80 && kept++ == keep) {
            break;
        }
    }
    buffer_append(out, name, (size_t)(end - name));
    buffer_format(out, "%s%*s", columns > width ? "..." : "", columns > width ? 0 : width - columns, "");
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

const char *table_axes(char out[TABLE_AXES_SIZE], const conus_report *report, const char *what)
{
    conus_space space = report->frame.space;
    snprintf(out, TABLE_AXES_SIZE, "%s %s, %s, %s", what, conus_space_axis(space, 0), conus_space_axis(space, 1),
             conus_space_axis(space, 2));
    return out;
}

int table_digits(const conus_report *report)
{
    return report->frame.space == CONUS_SPACE_CCF ? 1 : 2;
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
    bool is_one_pose = report->options.rows == CONUS_ROWS_SHARES && report_is_same_pose(report, 0, count - 1);
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
        if (report->options.rows == CONUS_ROWS_SHARES) {
            buffer_text(out, query->asked.cone.aperture == CONUS_APERTURE_SQUARE ? "square pyramids" : "cones");
        } else {
            write_shape(out, &query->asked.cone);
        }
        table_write_axis(out, report, query);
    }
    table_write_space(out, report);
}

static void write_rank(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    char rank[16] = "";
    char label[TABLE_LABEL_SIZE];
    if (result->object) {
        snprintf(rank, sizeof rank, "%u", result->rank);
    }
    buffer_format(out, "%4s  ", rank);
    table_write_name(out, table_name(report, result->object), width);
    buffer_format(out, "  %10s", table_label(label, report, result->object));
}

/* A number in a column of this width behind two spaces, "-" if it is none; then the unit, or nothing. */
static void write_number(struct buffer *out, int width, int digits, double value, const char *unit)
{
    if (isfinite(value)) {
        buffer_format(out, "  %*.*f%s", width, digits, value, unit);
    } else {
        buffer_format(out, "  %*s%*s", width, "-", (int)strlen(unit), "");
    }
}

static void write_short(struct buffer *out, double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.4g", value);
    buffer_format(out, "  %9s", isfinite(value) ? text : "-");
}

int report_share_digits(const conus_report *report)
{
    return report->selector.resolution >= 32;
}

const char *table_volume(char out[TABLE_VOLUME_SIZE], double volume)
{
    snprintf(out, TABLE_VOLUME_SIZE, volume > 0 && volume < 0.1 ? "%.3g" : "%.1f", volume);
    return out;
}

/* A volume in its column; likewise. */
static void write_volume(struct buffer *out, double volume)
{
    char text[TABLE_VOLUME_SIZE];
    buffer_format(out, "  %9s", isfinite(volume) ? table_volume(text, volume) : "-");
}

/* Tables are wide enough: beside bundles no column of means that all are "-". */
static bool has_means(const conus_report *report)
{
    bool found = !atlas_has_bundles(report->atlas);
    for (size_t i = 0; i < report->atlas->volume_count && !found; i++) {
        conus_role role = report->atlas->volumes[i].info.role;
        found = role != CONUS_ROLE_PARCELLATION && role != CONUS_ROLE_CONTEXT;
    }
    return found;
}

/* The columns of answers for people. */

enum shown { NUMBER, PERCENT, HUNDREDTHS, SHORT, VOLUME, COUNT, LARGE_COUNT, SHARE, STREAMLINES, POINT };

/* What a column needs to be there. */
enum needed { NOTHING, WEIGHT, POSTERIOR, DOSES, MEANS, BUNDLES };

/* The rows that have it; others have spaces there, or end before it. */
enum rows_with { ALL_ROWS, OBJECTS_ONLY, BUNDLES_ONLY };

struct people_column {
    const char *title, *below; /* Both lines of its head; of a point the axes' names and the unit are added. */
    int width;
    enum shown shown;
    int digits;
    size_t offset; /* In conus_result. */
    enum needed needed;
    enum rows_with rows;
};

/* The table of one kind of query. */
struct people_form {
    const struct people_column *columns;
    size_t count;
};

#define AT(member) .offset = offsetof(conus_result, member)
#define HIT_COLUMNS(below_pixels)                                                                                      \
    {"share", "of cone", 8, SHARE, 1, AT(share)}, {"pixels", below_pixels, 6, COUNT, 0, AT(pixels)},                   \
        {"weight", "of all", 8, PERCENT, 1, AT(weight), WEIGHT},                                                       \
        {"error", "%", 5, HUNDREDTHS, 1, AT(weight_error), WEIGHT},                                                    \
    {                                                                                                                  \
        "posterior", "", 9, PERCENT, 1, AT(posterior), POSTERIOR, OBJECTS_ONLY                                         \
    }
#define DOSE_COLUMNS                                                                                                   \
    {"dose", "of all", 8, PERCENT, 1, AT(dose_share), DOSES}, {"mean", "weight", 9, SHORT, 0, AT(mean_weight), DOSES}, \
    {                                                                                                                  \
        "above", "mm^3", 9, SHORT, 0, AT(above), DOSES                                                                 \
    }
#define BUNDLE_COLUMNS(where)                                                                                          \
    {"streamlines", where, 15, STREAMLINES, 0, AT(streamlines), BUNDLES, BUNDLES_ONLY},                                \
    {                                                                                                                  \
        "length", "mm", 9, NUMBER, 1, AT(length), BUNDLES, BUNDLES_ONLY                                                \
    }

static const struct people_column visible_columns[] = {
    HIT_COLUMNS(""),
    {"nearest", "mm", 9, NUMBER, 2, AT(distance), NOTHING, OBJECTS_ONLY},
    {"off axis", "degrees", 8, NUMBER, 2, AT(offset), NOTHING, OBJECTS_ONLY},
    {"contact", "", 26, POINT, 0, AT(contact), NOTHING, OBJECTS_ONLY},
};

static const struct people_column layers_columns[] = {
    HIT_COLUMNS("seen"),
    DOSE_COLUMNS,
    {"pixels", "pierced", 7, COUNT, 0, AT(pierced), NOTHING, OBJECTS_ONLY},
    {"enters", "mm", 8, NUMBER, 2, AT(entry), NOTHING, OBJECTS_ONLY},
    {"leaves", "mm", 8, NUMBER, 2, AT(exit), NOTHING, OBJECTS_ONLY},
    {"inside", "mm", 7, NUMBER, 2, AT(path), NOTHING, OBJECTS_ONLY},
    {"volume", "mm^3", 9, VOLUME, 0, AT(volume), NOTHING, OBJECTS_ONLY},
    {"of whole", "area", 8, PERCENT, 2, AT(fraction), NOTHING, OBJECTS_ONLY},
    {"mean", "value", 9, NUMBER, 4, AT(mean_value), MEANS, OBJECTS_ONLY},
    BUNDLE_COLUMNS("in the cone"),
};

static const struct people_column ball_columns[] = {
    {"share", "of ball", 8, PERCENT, 2, AT(share)},
    DOSE_COLUMNS,
    {"voxels", "", 8, LARGE_COUNT, 0, AT(voxels)},
    {"volume", "mm^3", 9, VOLUME, 0, AT(volume)},
    {"of whole", "area", 8, PERCENT, 2, AT(fraction), NOTHING, OBJECTS_ONLY},
    {"mean", "value", 9, NUMBER, 4, AT(mean_value), MEANS, OBJECTS_ONLY},
    {"distance", "mm", 8, NUMBER, 2, AT(distance), NOTHING, OBJECTS_ONLY},
    {"nearest point", "", 26, POINT, 0, AT(contact), NOTHING, OBJECTS_ONLY},
    BUNDLE_COLUMNS("in the ball"),
};

static const struct people_column point_columns[] = {
    {"distance", "mm", 8, NUMBER, 2, AT(distance)},
    {"nearest point", "", 26, POINT, 0, AT(contact)},
};

static bool is_there(const conus_report *report, enum needed needed)
{
    switch (needed) {
    case WEIGHT:
        return report->weight.form && !report->weight.by_depth;
    case POSTERIOR:
        return report->prior.power > 0;
    case DOSES:
        return report->weight.form;
    case MEANS:
        return has_means(report);
    case BUNDLES:
        return atlas_has_bundles(report->atlas);
    default:
        return true;
    }
}

static void write_heads(struct buffer *out, const conus_report *report, const struct people_form *form, int width)
{
    char axes[TABLE_AXES_SIZE];
    for (int line = 0; line < 2; line++) {
        buffer_format(out, "%4s  %-*s  %10s", line ? "" : "rank", width, line ? "" : "name", line ? "" : "label");
        for (const struct people_column *at = form->columns; at < form->columns + form->count; at++) {
            const char *head = line ? at->below : at->title;
            if (at->shown == POINT) {
                head = line ? conus_space_unit(report->frame.space) : table_axes(axes, report, at->title);
            }
            if (is_there(report, at->needed)) {
                buffer_format(out, "  %*s", at->width, head);
            }
        }
        buffer_text(out, "\n");
    }
}

static void write_people_cell(struct buffer *out, const conus_report *report, const struct people_column *column,
                              const conus_result *result)
{
    const void *at = (const char *)result + column->offset;
    const double *number = at;
    const int width = column->width;
    char text[48];
    double point[3];
    switch (column->shown) {
    case NUMBER:
        write_number(out, width, column->digits, *number, "");
        break;
    case PERCENT:
        write_number(out, width - 2, column->digits, 100 * *number, " %");
        break;
    case HUNDREDTHS:
        write_number(out, width, column->digits, 100 * *number, "");
        break;
    case SHORT:
        write_short(out, *number);
        break;
    case VOLUME:
        write_volume(out, *number);
        break;
    case COUNT:
        buffer_format(out, "  %*" PRIu32, width, *(const uint32_t *)at);
        break;
    case LARGE_COUNT:
        buffer_format(out, "  %*" PRIu64, width, *(const uint64_t *)at);
        break;
    case SHARE:
        buffer_format(out, "  %6s %%", text_share(text, *number, report_share_digits(report)));
        break;
    case STREAMLINES:
        snprintf(text, sizeof text, "%" PRIu64 " of %" PRIu64, result->streamlines, result->streamlines_total);
        buffer_format(out, "  %*s", width, text);
        break;
    case POINT:
        memcpy(point, number, sizeof point);
        report_point(report, point);
        for (int a = 0; a < 3; a++) {
            write_number(out, a ? 7 : 8, table_digits(report), point[a], "");
        }
        break;
    }
}

static void write_result(struct buffer *out, const conus_report *report, const struct people_form *form,
                         const conus_result *result, int width)
{
    int blank = 0;
    write_rank(out, report, result, width);
    for (const struct people_column *at = form->columns; at < form->columns + form->count; at++) {
        bool has_it = at->rows == ALL_ROWS || (at->rows == OBJECTS_ONLY && result->object) ||
                      (at->rows == BUNDLES_ONLY && result->kind == CONUS_KIND_BUNDLE);
        if (is_there(report, at->needed) && has_it) {
            buffer_format(out, "%*s", blank, "");
            write_people_cell(out, report, at, result);
            blank = 0;
        } else if (is_there(report, at->needed)) {
            blank += 2 + at->width;
        }
    }
}

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
static void write_answers(struct buffer *out, const conus_report *report, size_t index, int width)
{
    static const struct people_form visible = {visible_columns, sizeof visible_columns / sizeof visible_columns[0]};
    static const struct people_form layers = {layers_columns, sizeof layers_columns / sizeof layers_columns[0]};
    static const struct people_form ball = {ball_columns, sizeof ball_columns / sizeof ball_columns[0]};
    static const struct people_form point = {point_columns, sizeof point_columns / sizeof point_columns[0]};
    const struct people_form *form = report->queries[index].is_point         ? &point
                                     : report->queries[index].asked.ball > 0 ? &ball
                                     : report->selector.layers               ? &layers
                                                                             : &visible;
    table_write_atlas(out, report);
    if (report->queries[index].asked.ball > 0) {
        buffer_text(out, "at the point: ");
        write_here(out, report, index);
    }
    write_heads(out, report, form, width);
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        const conus_result *result = &report->rows[row].result;
        write_result(out, report, form, result, width);
        if (form == &point) {
            end_at_point(out, result);
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
    const int other = width_of(text);
    return other > width ? other : width;
}

static struct point_widths find_widths(const conus_report *report)
{
    struct point_widths widths = {.id = width_of("point")};
    bool has_near = false;
    for (const conus_report *of = report; of; of = of->next) {
        widths.atlas = of->name ? widest(widths.atlas, of->name) : 0;
        for (size_t row = 0; row < of->row_count; row++) {
            has_near = has_near || of->rows[row].result.distance > 0;
        }
    }
    for (size_t i = 0; i < report->query_count; i++) {
        struct buffer id = {0};
        write_id(&id, report, &report->queries[i]);
        widths.id = widest(widths.id, id.data ? id.data : "");
        buffer_finish(&id);
    }
    widths.id = widths.id > WIDEST_ID ? WIDEST_ID : widths.id;
    widths.gap = widths.atlas ? 2 : 0;
    widths.names = table_name_width(report) + (has_near ? width_of(nearest) : 0);
    return widths;
}

/* What one atlas has at a point, or nearest to it: a line each. `id` and `at` stand in the first line of the point. */
static void write_at_point(struct buffer *out, const conus_report *report, size_t index,
                           const struct point_widths *widths, const char *id, const char *at)
{
    char label[TABLE_LABEL_SIZE];
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        const conus_result *result = &report->rows[row].result;
        const char *before = result->distance > 0 ? nearest : "";
        table_write_name(out, id, widths->id);
        buffer_format(out, "  %*s  ", WIDTH_OF_POINT, at);
        table_write_name(out, report->name ? report->name : "", widths->atlas);
        buffer_format(out, "%*s%s", widths->gap, "", before);
        table_write_name(out, table_name(report, result->object), widths->names - width_of(before));
        buffer_format(out, "  %10s", table_label(label, report, result->object));
        write_number(out, 8, 2, result->distance, "");
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
    int width = table_name_width(report);
    for (size_t i = 0; i < report->query_count; i++) {
        if (report->queries[i].error) {
            table_write_error(out, report, &report->queries[i], i + 1 < report->query_count);
            continue;
        }
        table_write_query(out, report, &report->queries[i]);
        for (const conus_report *of = report; of && i < of->query_count; of = of->next) {
            write_answers(out, of, i, width);
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
