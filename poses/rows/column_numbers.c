/* SPDX-License-Identifier: BSD-3-Clause */
/* What the numbers of a table's head say against their unit, their signs or their sides. */
#include "base/geometry/math3.h"
#include "base/status.h"
#include "poses/rows/columns.h"
#include "poses/rows/columns_head.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* The numbers of the head's rows, mm or as the space has them. */
struct census {
    size_t points, outside_1, negatives, shallow, axes, short_axes;
    double farthest;
    struct sides sides;
    size_t bad, rows;
};

/* A column whose cells are all words of sides says them, whatever its header; else the name does. */
static int side_of_row(const struct head *head, struct text text, struct text name, size_t column)
{
    struct table_line line;
    return column != COLUMN_NONE && table_split(&line, &head->out->table, text) && column < line.count
               ? sides_of_name(line.cells[column])
               : sides_of_name(name);
}

/* The column of a side of the brain: not that of a hand. */
static size_t find_side_column(const struct head *head)
{
    static const char others[] = "hand/handed/handedness/eye/ear/foot/leg/arm/limb/finger/muscle/response";
    static const char neither[] = "midline/mid/both/bilateral/m/b";
    size_t found = COLUMN_NONE;
    for (size_t i = 0; i < head->line.count && found == COLUMN_NONE && head->out->has_header; i++) {
        struct text name = text_from(head->names[i]);
        struct text word;
        bool is_called = strstr(head->names[i], "hemi") || strcmp(head->names[i], "side") == 0;
        bool all = head->out->role_of[i] == ROLES || (is_called && head->out->role_of[i] == ROLE_NAME);
        size_t sides = 0;
        while (text_word(&name, &word)) {
            all = all && !text_is_one_of(word, others, false);
        }
        for (size_t r = 0; all && r < head->row_count; r++) {
            const struct text cell = columns_cell(head, r, i);
            sides += sides_of_name(cell) != 0;
            all = is_called || columns_is_absent(cell) || sides_of_name(cell) || text_is_one_of(cell, neither, false);
        }
        found = all && sides ? i : found;
    }
    return found;
}

static void count_row(struct census *census, const struct head *head, const conus_pose_row *row, int side,
                      struct text name, double width)
{
    double p[3];
    conus_frame_from_world(p, head->options->frame, row->pose.world_from_device + 12);
    const double *world = row->pose.world_from_device + 12;
    bool is_of_bregma = head->options->space == CONUS_SPACE_BREGMA;
    double distance = vec3_length(head->options->space < CONUS_SPACE_CCF ? world : p);
    census->points++;
    census->farthest = fmax(census->farthest, distance);
    census->negatives += p[0] < 0 || p[1] < 0 || p[2] < 0;
    census->shallow += is_of_bregma && row->is_point && p[2] > 0;
    if (isfinite(row->range[1]) && head->out->ends_at_target) {
        census->axes++;
        census->short_axes += row->range[1] < width / 20;
    }
    sides_count(&census->sides, side, name, is_of_bregma ? p[1] : world[0], width / 36);
}

static conus_status judge(const struct census *c, const struct head *head, struct notes *notes, double longest,
                          const char *first_fault)
{
    conus_space space = head->options->space;
    bool of_people = space < CONUS_SPACE_CCF;
    bool is_known = head->options->longest > 0;
    enum { LEAST = 3 };
    bool is_list = c->points >= LEAST && head->out->is_of_points;
    bool is_said = head->out->has_unit;
    if (c->rows > 1 && 2 * c->bad > c->rows && head->out->has_header) {
        return fail(CONUS_ERROR_DATA,
                    "%zu of %zu rows have no number where the header has x y z or a direction: is the order of the "
                    "columns another? The first: %s",
                    c->bad, c->rows, first_fault);
    }
    const struct sides *sides = &c->sides;
    size_t wrong = sides->left_on_right + sides->right_on_left;
    bool is_asked = is_known && !head->words.any_sides;
    char why[64];
    snprintf(why, sizeof why, "--space %s would turn x and y", space == CONUS_SPACE_LPS ? "ras" : "lps");
    conus_status status = is_asked && is_list ? sides_check(sides, why) : CONUS_OK;
    if (status) {
        return status;
    }
    if (is_list && !is_said && (of_people || space == CONUS_SPACE_BREGMA) && c->farthest > 0 &&
        c->farthest <= (of_people ? 1 : 0.02)) {
        return fail(CONUS_ERROR_DATA,
                    "all positions lie within %s mm of the origin, as if they were in metres; ',unit=m' behind FILE "
                    "takes them so, ',unit=mm' as mm",
                    of_people ? "1" : "0.02");
    }
    if (c->farthest > fmax(10 * longest, 1000) && of_people && is_known && !is_said) {
        return fail(CONUS_ERROR_DATA,
                    "a position lies %g mm from the origin, as if it were in micrometres; ',unit=um' behind FILE takes "
                    "them so, ',unit=mm' as mm",
                    c->farthest);
    }
    if (is_list && is_known && !is_said && space == CONUS_SPACE_CCF && c->farthest < 1000 * longest / 14) {
        return fail(
            CONUS_ERROR_DATA,
            "all positions lie within %.0f um of the corner, outside of any brain: are they voxels? space ccf is "
            "in micrometres; ',unit=um' behind FILE takes them so",
            1000 * longest / 14);
    }
    if (space == CONUS_SPACE_BREGMA && is_list && 2 * c->shallow > c->points) {
        return fail(
            CONUS_ERROR_DATA,
            "%zu of %zu positions have a DV above 0, above bregma: DV is up in space bregma, depths are negative",
            c->shallow, c->points);
    }
    if (is_known && c->axes && 2 * c->short_axes >= c->axes) {
        return columns_refuse_short(c->short_axes, c->axes, longest);
    }
    if (is_list && of_people && is_known && !is_said && c->farthest < longest / 14) {
        status = notes_warn(notes,
                            "all positions lie within %g mm of the origin: are they in centimetres? ',unit=cm' "
                            "behind FILE takes them so",
                            longest / 14);
    } else if (is_list && of_people && is_known && !c->negatives && !(sides->left && sides->right && !wrong)) {
        status = notes_warn(notes, "no position has a negative number: are they voxels, or positions in a frame?");
    }
    if (!status && is_asked && wrong) {
        status = notes_warn(notes, "%zu rows lie on the other side than their name says", wrong);
    }
    return status || !is_asked || !is_list ? status : sides_warn_of_shafts(sides, notes);
}

/* Whether a word stands where a number is to be, and a character that is no sign before a coordinate. */
static void find_faults(bool *has_word, bool *has_glyph, const struct columns *columns, struct text text)
{
    struct table_line line;
    bool fits = table_split(&line, &columns->table, text);
    *has_word = *has_glyph = false;
    for (size_t i = 0; fits && i < line.count && i < columns->count; i++) {
        double value;
        struct text cell = line.cells[i];
        bool is_word = !columns_is_absent(cell) && !table_number(&value, &columns->table, cell);
        size_t length = cell.size && (unsigned char)cell.data[0] >= 0x80 ? text_character(cell) : 0;
        *has_word |= is_word && columns->role_of[i] < ROLE_ANGLE;
        *has_glyph |= is_word && columns->role_of[i] < ROLE_X + 3 && length && length < cell.size &&
                      isdigit((unsigned char)cell.data[length]);
    }
}

/* What the numbers of the head say against their unit, their signs or their sides. The unit that the user or the
 * file states is not questioned. */
conus_status columns_check_numbers(const struct head *head, struct notes *notes)
{
    struct census census = {0};
    struct text rest = head->text;
    struct text text;
    const conus_pose_options *options = head->options;
    const double longest = options->longest; /* 0: what needs it is not asked */
    size_t column = find_side_column(head);
    char first_fault[256] = "";
    for (size_t number = 1; text_line(&rest, &text); number++) {
        conus_pose_row row = pose_row_at(number);
        struct pose_name name = {.text = {"", 0}};
        conus_status bad = CONUS_OK;
        enum columns_line kind = columns_read(&row, &name, &bad, head->out, text, number, options);
        bool has_word = false;
        bool has_glyph = false;
        census.rows += kind == LINE_ROW;
        if (kind == LINE_ROW && bad) {
            find_faults(&has_word, &has_glyph, head->out, text);
        } else if (kind == LINE_ROW) {
            count_row(&census, head, &row, side_of_row(head, text, name.text, column), name.text, longest);
        }
        if (has_glyph) {
            char where[128];
            snprintf(where, sizeof where, "line %zu: a character before a number that is no minus (as PDFs lose them)",
                     number);
            return fail_in(CONUS_ERROR_DATA, where);
        }
        if (has_word && !census.bad++) {
            snprintf(first_fault, sizeof first_fault, "%s", conus_message());
        }
    }
    return judge(&census, head, notes, longest, first_fault);
}
