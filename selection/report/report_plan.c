/* SPDX-License-Identifier: BSD-3-Clause */
/* The tables for people of plans: of poses, of their constraints, and of depths. */
#include "base/text.h"
#include "selection/report/parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* How tables for people call columns; others are called as they are, up to their units. */
static const struct {
    const char *name, *title;
} titles[] = {{"query", "candidate"},
              {"far_mm", "depth"},
              {"entry_angle_deg", "angle"},
              {"tip_x", "tip x"},
              {"tip_y", "tip y"},
              {"tip_z", "tip z"},
              {"arc1_deg", "arc"},
              {"slider1_deg", "slider"},
              {"leeway_of", "of"},
              {"clearance_of", "from"},
              {"clearance_at_mm", "at depth"},
              {"broken", "breaks"},
              {"depth_mm", "depth"},
              {"p_ok", "p ok"}};

/* Their columns: of plans; of several needles together where they are, and how much room they have; of others all. */
static const char ALL[] = "";
static const char PLANS[] = "query/rank/broken/x/y/z/far_mm/entry_angle_deg/leeway_mm/clearance_mm/clearance_of/"
                            "clearance_at_mm/score/p_ok";
static const char PLACES[] = "needle/x/y/z/tip_x/tip_y/tip_z/arc_deg/slider_deg/arc1_deg/slider1_deg";
static const char ROOM[] = "needle/row/query/broken/far_mm/entry_angle_deg/leeway_mm/clearance_mm/clearance_of/"
                           "clearance_at_mm";

/* Whether a table leaves a column out: -o FILE has it. */
static bool is_left_out(const conus_report *report, const struct report_column *column, const char *table)
{
    const struct report_needles *needles = &report->needles;
    if (column->home == HOME_VERDICTS && table == PLANS) {
        return column->offset % sizeof(conus_verdict) == offsetof(conus_verdict, p) ||
               report_is_clearance(&report->plan.constraints[column->offset / sizeof(conus_verdict)]);
    }
    bool is_idle = (column->home == HOME_NEEDLE && needles->asked->arcs > 0) ||
                   (strcmp(column->name, "row") == 0 && needles->question_count == needles->count);
    return *table && (is_idle || !text_is_one_of(text_from(column->name), table, true));
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
            bool is_zero = fabs(cell.number) < 0.5 * pow(10, -digits); /* and not -0.00 */
            snprintf(out, CELL_SIZE, "%.*f", digits, is_zero ? 0 : cell.number);
        }
        return cell.type != CELL_NONE;
    }
    return true;
}

/* What of all needles together, which are given and hold each alone, is not as it was asked for. */
static const char *broken_limit(const conus_together_options *asked, const conus_combination *combination)
{
    for (size_t k = 0; k < asked->cover_count; k++) {
        if (combination->covered[k] < asked->covers[k].contacts) {
            return "these needles have too few contacts in covers";
        }
    }
    return "these needles are on too many arcs, or too many on one arc";
}

/* "combination 1: leeway 3.19 mm (A/B), sum 47.2 mm", and on a line of its own "proven: ..." */
static void write_combination(struct buffer *out, const struct report_needles *needles, size_t number)
{
    const conus_combination *combination = needles->combinations[number - 1];
    const conus_conflict *conflict = needles->conflict;
    const char *others = number > 1 ? "none that differs enough" : "none";
    if (!combination->feasible) {
        buffer_format(out, "%s\n",
                      conflict->by_limits    ? broken_limit(needles->asked, combination)
                      : conflict->count == 1 ? "some needle breaks a constraint of its own"
                                             : "these needles do not go together");
        return;
    }
    buffer_format(out, "%scombination %zu: ", number > 1 ? "\n" : "", number);
    if (combination->leeway_of) {
        buffer_format(out, "leeway %.2f mm (%s), ", combination->leeway, combination->leeway_of);
    }
    buffer_format(out, "sum %.2f mm", combination->sum);
    if (needles->asked->cover_count) {
        buffer_format(out, ", %llu contacts in covers", (unsigned long long)combination->contacts);
    }
    if (combination->proven) {
        buffer_format(out, "\nproven: %s has a larger leeway, and with that a larger sum\n", others);
    } else if (combination->leeway_of) {
        buffer_format(out, "\nnot proven: %s has a leeway of more than %.2f mm\n", others, combination->bound);
    } else {
        buffer_text(out, "\nnot proven\n");
    }
}

static bool is_of_words(const struct report_column *column)
{
    return column->type == COLUMN_NAME || column->type == COLUMN_TEXT;
}

/* Cuts candidates where a table is too wide for a terminal. Names of needles and areas stay whole: they differ at their
 * ends, by numbers and sides. */
static void fit_widths(int *widths, const struct report_columns *columns)
{
    enum { TERMINAL = 80, GAP = 2, CANDIDATE_LEAST = 12 };
    int over = -TERMINAL - GAP;
    for (size_t c = 0; c < columns->count; c++) {
        over += widths[c] ? widths[c] + GAP : 0;
    }
    for (size_t c = 0; c < columns->count; c++) {
        while (over > 0 && widths[c] > CANDIDATE_LEAST && strcmp(columns->at[c]->name, "query") == 0) {
            widths[c]--;
            over--;
        }
    }
}

/* Finds how wide the columns of a table are; 0 = they are not in it. */
static void find_widths(int *widths, const conus_report *report, const struct report_columns *columns,
                        const char *table)
{
    char text[CELL_SIZE];
    for (size_t c = 0; c < columns->count; c++) {
        bool is_empty = true;
        widths[c] = 0;
        for (size_t i = 0; i < report->row_count + 2; i++) {
            is_empty = !(read_line(text, report, columns->at[c], i) && i > 1) && is_empty;
            widths[c] = table_wider(widths[c], text);
        }
        widths[c] = is_empty || is_left_out(report, columns->at[c], table) ? 0 : widths[c];
    }
    if (table == PLACES || table == ROOM) {
        fit_widths(widths, columns);
    }
}

/* Writes a line of the table. */
static void write_line(struct buffer *out, const conus_report *report, const struct report_columns *columns,
                       const int *widths, size_t line)
{
    char text[CELL_SIZE];
    const char *gap = "";
    for (size_t c = 0; c < columns->count; c++) {
        const bool is_name = is_of_words(columns->at[c]);
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

/* Writes the titles, and the rows from the line `first` on. */
static void write_lines(struct buffer *out, const conus_report *report, const struct report_columns *columns,
                        const int *widths, size_t first, size_t count)
{
    write_line(out, report, columns, widths, 0);
    write_line(out, report, columns, widths, 1);
    for (size_t i = 0; i < count; i++) {
        write_line(out, report, columns, widths, first + i);
    }
}

void report_write_plan(struct buffer *out, const conus_report *report)
{
    int widths[2][REPORT_COLUMN_LIMIT];
    const struct report_needles *needles = &report->needles;
    struct report_columns columns;
    report_list_columns(&columns, report);
    if (report->kind == ROWS_PLAN) { /* the rank first */
        const struct report_column *query = columns.at[0];
        columns.at[0] = columns.at[1];
        columns.at[1] = query;
    }
    find_widths(widths[0], report, &columns, needles->count ? PLACES : report->kind == ROWS_PLAN ? PLANS : ALL);
    if (needles->count) {
        find_widths(widths[1], report, &columns, ROOM);
    } else if (report->row_count) {
        write_lines(out, report, &columns, widths[0], 2, report->row_count);
    }
    for (size_t n = 0; n < needles->combination_count; n++) { /* of each a table of the places, and one of the room */
        write_combination(out, needles, n + 1);
        write_lines(out, report, &columns, widths[0], 2 + n * needles->count, needles->count);
        buffer_text(out, "\n");
        write_lines(out, report, &columns, widths[1], 2 + n * needles->count, needles->count);
    }
    buffer_text(out, report->row_count ? ""
                     : !needles->count ? "(no pose holds all constraints)\n"
                                       : "(no combination)\n");
    table_write_sources(out, report);
}
