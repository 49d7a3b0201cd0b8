/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes lines of tables for people by what is to be shown of a row, and the names, labels and numbers in them. */
#include "atlas/atlas.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_LIMIT = 48 };

int table_width(const char *text)
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
    int wanted = table_width(name);
    wanted = wanted < NAME_LIMIT ? wanted : NAME_LIMIT;
    return wanted > width ? wanted : width;
}

double report_number(const struct report_row *row, const char *column)
{
    return conus_table_numbers(row->of_table.table, column)[row->of_table.index];
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

void table_write_name(struct buffer *out, const char *name, int width)
{
    int columns = table_width(name);
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

int report_share_digits(const conus_report *report)
{
    return report->selector.resolution >= 32;
}

const char *table_volume(char out[TABLE_VOLUME_SIZE], double volume)
{
    snprintf(out, TABLE_VOLUME_SIZE, volume > 0 && volume < 0.1 ? "%.3g" : "%.1f", volume);
    return out;
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

static bool is_there(const conus_report *report, const struct shown *shown)
{
    switch (shown->with) {
    case WITH_LAYERS:
        return report->selector.layers;
    case WITH_WEIGHT:
        return report->weight.form && !report->weight.by_depth;
    case WITH_POSTERIOR:
        return report->prior.power > 0;
    case WITH_DOSES:
        return report->weight.form;
    case WITH_MEANS:
        return has_means(report);
    case WITH_BUNDLES:
        return atlas_has_bundles(report->atlas);
    default:
        return true;
    }
}

static const char *text_of(const struct report_row *row, const struct shown *shown)
{
    const conus_table *table = row->of_table.table;
    const conus_column *beside = conus_table_find(table, shown->beside ? shown->beside : "");
    bool is_none = beside && beside->missing && beside->missing[row->of_table.index];
    const char *text = is_none ? shown->none : conus_table_texts(table, shown->column)[row->of_table.index];
    return text ? text : "";
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

struct layout table_lay_out(const conus_report *report, const struct shown *columns)
{
    struct layout layout = {.columns = columns};
    for (size_t i = 0; columns[i].title; i++) {
        assert(i < SHOWN_LIMIT);
        layout.widths[i] = find_width(report, &columns[i], columns);
    }
    return layout;
}

enum { CELL_SIZE = 128 };

static bool is_left(const struct shown *shown)
{
    return shown->look == LOOK_NAME || shown->look == LOOK_TEXT;
}

static const void *member_of(const struct report_row *row, const struct shown *shown)
{
    return (const char *)&row->result + shown->offset;
}

static void read_point(double out[3], const conus_report *report, const struct report_row *row,
                       const struct shown *shown)
{
    if (!shown->column) {
        memcpy(out, member_of(row, shown), 3 * sizeof *out);
        report_point(report, out);
        return;
    }
    for (int a = 0; a < 3; a++) {
        char column[32];
        snprintf(column, sizeof column, "%s%c", shown->column, "xyz"[a]);
        out[a] = report_number(row, column);
    }
}

static void write_point(char out[CELL_SIZE], const conus_report *report, const struct report_row *row,
                        const struct shown *shown)
{
    double p[3];
    const int digits = table_digits(report);
    const int width = (shown->width - 10) / 2; /* of y and z: x has 8, and a space is before each */
    read_point(p, report, row, shown);
    if (shown->look == LOOK_PLACE) {
        snprintf(out, CELL_SIZE, "%.*f, %.*f, %.*f", digits, p[0], digits, p[1], digits, p[2]);
    } else if (isfinite(p[0] + p[1] + p[2])) { /* of a position without a normal it is n/a */
        snprintf(out, CELL_SIZE, "%8.*f %*.*f %*.*f", digits, p[0], width, digits, p[1], width, digits, p[2]);
    } else if (shown->none) {
        snprintf(out, CELL_SIZE, "%8s %*s %*s", shown->none, width, shown->none, width, shown->none);
    }
}

/* Writes a number; nothing where it is n/a. */
static void write_number(char out[CELL_SIZE], const conus_report *report, const struct report_row *row,
                         const struct shown *shown)
{
    const double *member = member_of(row, shown);
    const double number = shown->column ? report_number(row, shown->column) : *member;
    if (!isfinite(number)) {
        return;
    }
    if (shown->look == LOOK_SHORT) {
        snprintf(out, CELL_SIZE, "%.*g", shown->digits, number);
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

/* Likewise. */
static void write_count(char out[CELL_SIZE], const struct report_row *row, const struct shown *shown)
{
    const void *member = member_of(row, shown);
    const conus_column *column = shown->column ? conus_table_find(row->of_table.table, shown->column) : NULL;
    if (!column) {
        snprintf(out, CELL_SIZE, "%" PRIu64, shown->size == 4 ? *(const uint32_t *)member : *(const uint64_t *)member);
    } else if (!column->missing || !column->missing[row->of_table.index]) {
        snprintf(out, CELL_SIZE, "%lld", (long long)column->counts[row->of_table.index]);
    }
}

/* Writes a value that stands at the right. */
static void write_right(struct buffer *out, const conus_report *report, const struct report_row *row,
                        const struct shown *shown)
{
    char text[CELL_SIZE] = "";
    if (shown->look == LOOK_LABEL) {
        table_label(text, report, row->result.object);
    } else if (shown->look >= LOOK_POINT) {
        write_point(text, report, row, shown);
    } else if (shown->look == LOOK_STREAMLINES) {
        snprintf(text, sizeof text, "%" PRIu64 " of %" PRIu64, row->result.streamlines, row->result.streamlines_total);
    } else if (shown->look == LOOK_COUNT) {
        write_count(text, row, shown);
    } else {
        write_number(text, report, row, shown);
    }
    const char *after = text[0] && shown->after ? shown->after : "";
    const char *none = shown->none ? shown->none : "";
    buffer_format(out, "%*s%s", shown->width - (int)strlen(after), text[0] ? text : none, after);
}

void table_write_heading(struct buffer *out, const conus_report *report, const struct layout *layout, bool is_unit)
{
    for (const struct shown *shown = layout->columns; shown->title; shown++) {
        char axes[TABLE_AXES_SIZE];
        const char *title = shown->unit ? shown->title : table_axes(axes, report, shown->title);
        const char *unit = shown->unit ? shown->unit : conus_space_unit(report->frame.space);
        const int width = layout->widths[shown - layout->columns];
        if (is_there(report, shown)) {
            buffer_format(out, "%s%*s", shown == layout->columns ? "" : "  ", is_left(shown) ? -width : width,
                          is_unit ? unit : title);
        }
    }
    buffer_text(out, "\n");
}

void table_write_row(struct buffer *out, const conus_report *report, const struct layout *layout,
                     const struct report_row *row)
{
    const uint32_t object = row->result.object;
    int blank = 0;
    for (const struct shown *shown = layout->columns; shown->title; shown++) {
        const int width = layout->widths[shown - layout->columns];
        if (!is_there(report, shown)) {
            continue;
        }
        blank += shown == layout->columns ? 0 : 2;
        if ((shown->in == IN_OBJECTS && !object) ||
            (shown->in == IN_BUNDLES && row->result.kind != CONUS_KIND_BUNDLE)) {
            blank += width;
            continue;
        }
        buffer_format(out, "%*s", blank, "");
        blank = 0;
        if (is_left(shown)) {
            const char *text = shown->look == LOOK_TEXT ? text_of(row, shown)
                               : object                 ? table_name(report, object)
                                                        : shown->none;
            table_write_name(out, text, width);
        } else {
            write_right(out, report, row, shown);
        }
    }
}
