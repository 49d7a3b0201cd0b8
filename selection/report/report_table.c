/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of answers for people, aligned, with units; and what all tables for people have in common. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <math.h>
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

/* The dose's share, the mean weight and the volume above the level, where there is a weight. */
static void write_dose(struct buffer *out, const conus_report *report, const conus_result *result)
{
    if (report->weight.form) {
        write_number(out, 6, 1, 100 * result->dose_share, " %");
        write_short(out, result->mean_weight);
        write_short(out, result->above);
    }
}

static void write_dose_header(struct buffer *out, const conus_report *report, bool is_first)
{
    if (report->weight.form) {
        buffer_format(out, "  %8s  %9s  %9s", is_first ? "dose" : "of all", is_first ? "mean" : "weight",
                      is_first ? "above" : "mm^3");
    }
}

/* In percent, behind the pixels, with a weight of rays. */
static void write_weight(struct buffer *out, const conus_report *report, const conus_result *result)
{
    if (report->weight.form && !report->weight.by_depth) {
        write_number(out, 6, 1, 100 * result->weight, " %");
        write_number(out, 5, 1, 100 * result->weight_error, "");
    }
    if (report->prior.power > 0 && result->object) {
        write_number(out, 7, 1, 100 * result->posterior, " %");
    } else if (report->prior.power > 0 && report->selector.layers) {
        buffer_format(out, "  %9s", "");
    }
    if (report->selector.layers) {
        write_dose(out, report, result);
    }
}

static void write_label(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    char share[TABLE_SHARE_SIZE];
    write_rank(out, report, result, width);
    buffer_format(out, "  %6s %%  %6u", table_share(share, result->share, report->selector.resolution), result->pixels);
    write_weight(out, report, result);
}

/* The first or second line above the columns of write_label(). */
static void write_label_header(struct buffer *out, const conus_report *report, int width, bool is_first,
                               const char *below_pixels)
{
    buffer_format(out, "%4s  %-*s  %10s  %8s  %6s", is_first ? "rank" : "", width, is_first ? "name" : "",
                  is_first ? "label" : "", is_first ? "share" : "of cone", is_first ? "pixels" : below_pixels);
    if (report->weight.form && !report->weight.by_depth) {
        buffer_format(out, "  %8s  %5s", is_first ? "weight" : "of all", is_first ? "error" : "%");
    }
    if (report->prior.power > 0) {
        buffer_format(out, "  %9s", is_first ? "posterior" : "");
    }
    if (report->selector.layers) {
        write_dose_header(out, report, is_first);
    }
}

const char *table_share(char out[TABLE_SHARE_SIZE], double share, uint32_t resolution)
{
    const int digits = resolution >= 32;
    const double least = digits ? 0.1 : 1;
    const double percent = 100 * share;
    bool is_less = percent > 0 && percent < least / 2;
    snprintf(out, TABLE_SHARE_SIZE, "%s%.*f", is_less ? "<" : "", digits, is_less ? least : percent);
    return out;
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

static void write_mean_header(struct buffer *out, const conus_report *report, const char *words)
{
    if (has_means(report)) {
        buffer_format(out, "  %9s", words);
    }
}

static void write_mean(struct buffer *out, const conus_report *report, const conus_result *result)
{
    if (has_means(report)) {
        write_number(out, 9, 4, result->mean_value, "");
    }
}

static void write_visible_result(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    write_label(out, report, result, width);
    if (result->object) {
        double contact[3];
        memcpy(contact, result->contact, sizeof contact);
        report_point(report, contact);
        write_number(out, 9, 2, result->distance, "");
        write_number(out, 8, 2, result->offset, "");
        write_number(out, 8, table_digits(report), contact[0], "");
        write_number(out, 7, table_digits(report), contact[1], "");
        write_number(out, 7, table_digits(report), contact[2], "");
    }
    buffer_text(out, "\n");
}

static void write_visible_header(struct buffer *out, const conus_report *report, int width)
{
    char axes[TABLE_AXES_SIZE];
    write_label_header(out, report, width, true, "");
    buffer_format(out, "  %9s  %8s  %26s\n", "nearest", "off axis", table_axes(axes, report, "contact"));
    write_label_header(out, report, width, false, "");
    buffer_format(out, "  %9s  %8s  %26s\n", "mm", "degrees", conus_space_unit(report->frame.space));
}

/* Appends the columns of bundles, where there are bundles, and ends the line. Where along the bundle that is,
 * TSV and JSON have. */
static void end_result(struct buffer *out, const conus_result *result)
{
    char counts[48];
    if (result->kind == CONUS_KIND_BUNDLE) {
        snprintf(counts, sizeof counts, "%llu of %llu", (unsigned long long)result->streamlines,
                 (unsigned long long)result->streamlines_total);
        buffer_format(out, "  %15s", counts);
        write_number(out, 9, 1, result->length, "");
    }
    buffer_text(out, "\n");
}

static void end_header(struct buffer *out, const conus_report *report, const char *streamlines, const char *length)
{
    if (atlas_has_bundles(report->atlas)) {
        buffer_format(out, "  %15s  %9s", streamlines, length);
    }
    buffer_text(out, "\n");
}

static void write_layers_result(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    write_label(out, report, result, width);
    if (result->object) {
        buffer_format(out, "  %7u", result->pierced);
        write_number(out, 8, 2, result->entry, "");
        write_number(out, 8, 2, result->exit, "");
        write_number(out, 7, 2, result->path, "");
        write_volume(out, result->volume);
        write_number(out, 6, 2, 100 * result->fraction, " %");
        write_mean(out, report, result);
    }
    end_result(out, result);
}

static void write_layers_header(struct buffer *out, const conus_report *report, int width)
{
    static const char form[] = "  %7s  %8s  %8s  %7s  %9s  %8s";
    write_label_header(out, report, width, true, "seen");
    buffer_format(out, form, "pixels", "enters", "leaves", "inside", "volume", "of whole");
    write_mean_header(out, report, "mean");
    end_header(out, report, "streamlines", "length");
    write_label_header(out, report, width, false, "seen");
    buffer_format(out, form, "pierced", "mm", "mm", "mm", "mm^3", "area");
    write_mean_header(out, report, "value");
    end_header(out, report, "in the cone", "mm");
}

void table_write_error(struct buffer *out, const conus_report *report, const struct report_query *query, bool more)
{
    table_write_id(out, report, query);
    buffer_format(out, "no answer: %s\n%s", query->error, more ? "\n" : "");
}

static void write_ball_result(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    double contact[3];
    memcpy(contact, result->contact, sizeof contact);
    report_point(report, contact);
    write_rank(out, report, result, width);
    write_number(out, 6, 2, 100 * result->share, " %");
    write_dose(out, report, result);
    buffer_format(out, "  %8llu", (unsigned long long)result->voxels);
    write_volume(out, result->volume);
    if (result->object) {
        write_number(out, 6, 2, 100 * result->fraction, " %");
        write_mean(out, report, result);
        write_number(out, 8, 2, result->distance, "");
        write_number(out, 8, table_digits(report), contact[0], "");
        write_number(out, 7, table_digits(report), contact[1], "");
        write_number(out, 7, table_digits(report), contact[2], "");
    }
    end_result(out, result);
}

static void write_ball_header(struct buffer *out, const conus_report *report, int width)
{
    char axes[TABLE_AXES_SIZE];
    static const char form[] = "  %8s  %9s  %8s";
    static const char label[] = "%4s  %-*s  %10s  %8s";
    buffer_format(out, label, "rank", width, "name", "label", "share");
    write_dose_header(out, report, true);
    buffer_format(out, form, "voxels", "volume", "of whole");
    write_mean_header(out, report, "mean");
    buffer_format(out, "  %8s  %26s", "distance", table_axes(axes, report, "nearest point"));
    end_header(out, report, "streamlines", "length");
    buffer_format(out, label, "", width, "", "", "of ball");
    write_dose_header(out, report, false);
    buffer_format(out, form, "", "mm^3", "area");
    write_mean_header(out, report, "value");
    buffer_format(out, "  %8s  %26s", "mm", conus_space_unit(report->frame.space));
    end_header(out, report, "in the ball", "mm");
}

static void write_point_result(struct buffer *out, const conus_report *report, const conus_result *result, int width)
{
    double contact[3];
    memcpy(contact, result->contact, sizeof contact);
    report_point(report, contact);
    write_rank(out, report, result, width);
    write_number(out, 8, 2, result->distance, "");
    write_number(out, 8, table_digits(report), contact[0], "");
    write_number(out, 7, table_digits(report), contact[1], "");
    write_number(out, 7, table_digits(report), contact[2], "");
    if (isfinite(result->contact_value)) {
        buffer_format(out, "  value %.4g", result->contact_value);
    }
    buffer_text(out, "\n");
}

static void write_point_header(struct buffer *out, const conus_report *report, int width)
{
    char axes[TABLE_AXES_SIZE];
    buffer_format(out, "%4s  %-*s  %10s  %8s  %26s\n", "rank", width, "name", "label", "distance",
                  table_axes(axes, report, "nearest point"));
    buffer_format(out, "%4s  %-*s  %10s  %8s  %26s\n", "", width, "", "", "mm", conus_space_unit(report->frame.space));
}

/* The table of one kind of query. */
struct table_form {
    void (*header)(struct buffer *out, const conus_report *report, int width);
    void (*result)(struct buffer *out, const conus_report *report, const conus_result *result, int width);
};

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
    static const struct table_form visible = {write_visible_header, write_visible_result};
    static const struct table_form layers = {write_layers_header, write_layers_result};
    static const struct table_form ball = {write_ball_header, write_ball_result};
    static const struct table_form point = {write_point_header, write_point_result};
    const struct table_form *form = report->queries[index].is_point         ? &point
                                    : report->queries[index].asked.ball > 0 ? &ball
                                    : report->selector.layers               ? &layers
                                                                            : &visible;
    table_write_atlas(out, report);
    if (report->queries[index].asked.ball > 0) {
        buffer_text(out, "at the point: ");
        write_here(out, report, index);
    }
    form->header(out, report, width);
    for (size_t row = report->queries[index].first_row; row < report_row_end(report, index); row++) {
        form->result(out, report, &report->rows[row].result, width);
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
        if (isfinite(result->contact_value)) {
            buffer_format(out, "  value %.4g", result->contact_value);
        }
        buffer_text(out, "\n");
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
