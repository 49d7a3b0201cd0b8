/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables for people of plans: of poses, of their constraints, and of depths. */
#include "selection/report/parts.h"

#include <stdio.h>
#include <string.h>

/* How tables for people call columns; others are called as they are, up to their units. */
static const struct {
    const char *name, *title;
} titles[] = {{"query", "candidate"}, {"far_mm", "depth"},      {"entry_angle_deg", "angle"},
              {"leeway_of", "of"},    {"clearance_of", "from"}, {"clearance_at_mm", "at depth"},
              {"broken", "breaks"},   {"depth_mm", "depth"},    {"p_ok", "p ok"}};

/* Columns that the table of poses leaves out: -o FILE has them. */
static bool is_left_out(const conus_report *report, const struct report_column *column)
{
    static const char *const names[] = {"feasible", "entry", "target", "dx",        "dy",       "dz",
                                        "tip_x",    "tip_y", "tip_z",  "leeway_of", "slack_mm", NULL};
    static const char *const of_needles[] = {"combination", "proven",     "all_leeway_mm", "all_leeway_of",
                                             "all_bound",   "all_sum_mm", "all_depth_mm",  "all_contacts",
                                             "row",         NULL};
    const bool are_needles = report->kind == ROWS_NEEDLES;
    bool is = column->home == HOME_NEEDLE ||
              (column->home == HOME_VERDICTS &&
               (column->offset % sizeof(conus_verdict) == offsetof(conus_verdict, p) ||
                report_is_clearance(&report->plan.constraints[column->offset / sizeof(conus_verdict)])));
    for (size_t i = 0; names[i] && !is; i++) {
        is = strcmp(names[i], column->name) == 0;
    }
    for (size_t i = 0; are_needles && of_needles[i] && !is; i++) {
        is = strcmp(of_needles[i], column->name) == 0;
    }
    return is && (are_needles || report->kind == ROWS_PLAN);
}

enum { CELL_SIZE = 128 };

static void write_title(char out[CELL_SIZE], const struct report_column *column)
{
    size_t i = 0;
    while (i < sizeof titles / sizeof titles[0] && strcmp(titles[i].name, column->name) != 0) {
        i++;
    }
    bool is_listed = i < sizeof titles / sizeof titles[0];
    const char *name = is_listed ? titles[i].title : column->name;
    snprintf(out, CELL_SIZE, "%.*s", (int)(is_listed ? strlen(name) : strcspn(name, "_")), name);
}

/* The text of line `line`: the title, the unit, and from 2 on the rows. False of a cell without a value. */
static bool read_line(char out[CELL_SIZE], const conus_report *report, const struct report_column *column, size_t line)
{
    const char *units = report_units(report, column);
    if (line == 0) {
        write_title(out, column);
    } else if (line == 1) {
        snprintf(out, CELL_SIZE, "%s", !units ? "" : strcmp(units, "degree") == 0 ? "degrees" : units);
    } else {
        const struct cell cell = report_cell(report, column, &report->rows[line - 2]);
        int digits = column->type >= COLUMN_X ? table_digits(report) : 2;
        snprintf(out, CELL_SIZE, "-");
        if (cell.type == CELL_TEXT) {
            snprintf(out, CELL_SIZE, "%s", cell.text);
        } else if (cell.type == CELL_INTEGER) {
            snprintf(out, CELL_SIZE, "%llu", (unsigned long long)cell.integer);
        } else if (cell.type == CELL_NUMBER) {
            snprintf(out, CELL_SIZE, "%.*f", digits, cell.number);
        }
        return cell.type != CELL_NONE;
    }
    return true;
}

/* "combination 1: leeway 3.19 mm (A/B), sum 47.2 mm; proven: ..." */
static void write_combination(struct buffer *out, const conus_combination *combination, size_t number, bool has_covers)
{
    const char *others = number > 1 ? "no other one that differs enough from those before it" : "none";
    if (!combination->feasible) {
        buffer_text(out, "these needles break something\n");
        return;
    }
    buffer_format(out, "%scombination %zu: ", number > 1 ? "\n" : "", number);
    if (combination->leeway_of) {
        buffer_format(out, "leeway %.2f mm (%s), ", combination->leeway, combination->leeway_of);
    }
    buffer_format(out, "sum %.2f mm", combination->sum);
    if (has_covers) {
        buffer_format(out, ", %llu contacts in covers", (unsigned long long)combination->contacts);
    }
    buffer_text(out, "; ");
    if (combination->proven) {
        buffer_format(out, "proven: %s has a larger leeway, and with that a larger sum\n", others);
    } else if (combination->leeway_of) {
        buffer_format(out, "not proven: %s has a leeway of more than %.2f mm\n", others, combination->bound);
    } else {
        buffer_text(out, "not proven\n");
    }
}

/* Writes a line of the table. */
static void write_line(struct buffer *out, const conus_report *report, const struct report_columns *columns,
                       const int *widths, size_t line)
{
    char text[CELL_SIZE];
    const char *gap = "";
    for (size_t c = 0; c < columns->count; c++) {
        bool is_name = columns->at[c]->type == COLUMN_NAME || columns->at[c]->type == COLUMN_TEXT;
        read_line(text, report, columns->at[c], line);
        if (widths[c]) {
            buffer_format(out, "%s%*s", gap, is_name ? 0 : widths[c] - table_wider(0, text), "");
            table_write_name(out, text, is_name ? widths[c] : table_wider(0, text));
            gap = "  ";
        }
    }
    while (out->size && out->data[out->size - 1] == ' ') {
        out->size--;
    }
    buffer_text(out, "\n");
}

void report_write_plan(struct buffer *out, const conus_report *report)
{
    char text[CELL_SIZE];
    int widths[REPORT_COLUMN_LIMIT];
    size_t lines = report->row_count ? report->row_count + 2 : 0;
    struct report_columns columns;
    report_list_columns(&columns, report);
    if (report->kind == ROWS_PLAN) { /* the rank first */
        const struct report_column *query = columns.at[0];
        columns.at[0] = columns.at[1];
        columns.at[1] = query;
    }
    for (size_t c = 0; c < columns.count; c++) {
        bool is_empty = true;
        widths[c] = 0;
        for (size_t i = 0; i < lines; i++) {
            is_empty = !(read_line(text, report, columns.at[c], i) && i > 1) && is_empty;
            widths[c] = table_wider(widths[c], text);
        }
        widths[c] = is_empty || is_left_out(report, columns.at[c]) ? 0 : widths[c];
    }
    /* Of needles a table for each combination. */
    size_t each = report->needles.count ? report->needles.count : lines;
    for (size_t first = 2; first < lines; first += each) {
        size_t n = report->rows[first - 2].planned.combination;
        if (report->needles.count) {
            write_combination(out, report->needles.combinations[n], n + 1, report->needles.asked->cover_count);
        }
        write_line(out, report, &columns, widths, 0);
        write_line(out, report, &columns, widths, 1);
        for (size_t i = first; i < lines && i < first + each; i++) {
            write_line(out, report, &columns, widths, i);
        }
    }
    buffer_text(out, lines                        ? ""
                     : report->needles.count == 0 ? "(no pose holds all constraints)\n"
                                                  : "(no combination)\n");
    table_write_sources(out, report);
}
