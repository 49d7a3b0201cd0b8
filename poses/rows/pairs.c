/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes an axis of two rows. */
#include "poses/rows/columns.h"

#include "base/geometry/math3.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"

#include <string.h>

/* By name, the entry (trigger false) before its target. */
static int compare_names(const void *left, const void *right)
{
    const conus_pose_row *a = left;
    const conus_pose_row *b = right;
    int order = strcmp(a->id, b->id);
    return order ? order : (a->trigger > b->trigger) - (a->trigger < b->trigger);
}

/* Pairs of two, by the entry. */
static int compare_lines(const void *left, const void *right)
{
    return compare_unsigned(((const conus_pose_row *)left)->line, ((const conus_pose_row *)right)->line);
}

/* Adds the row that a line is to `ends`; one with an error goes to the list at once. */
static conus_status add_line(conus_pose_list *ends, conus_pose_list *list, const struct columns *columns,
                             struct text line, size_t number, const conus_pose_options *options)
{
    struct table_line cells;
    struct pose_name name = {.text = {"", 0}};
    conus_pose_row row = pose_row_at(number);
    conus_status bad = CONUS_OK;
    enum columns_line kind = columns_read(&row, &name, &bad, columns, line, number, options);
    conus_status status = kind == LINE_ROW ? CONUS_OK : columns_hear_late(columns, line, number, options);
    if (status || kind != LINE_ROW || bad) {
        return status || kind != LINE_ROW ? status : pose_list_add(list, &row, name.text, conus_message());
    }
    bool fits = table_split(&cells, &columns->table, line) && columns->pairs <= cells.count;
    struct text word = fits ? cells.cells[columns->pairs - 1] : (struct text){"", 0};
    row.trigger = columns_end_of(word) == END_TARGET;
    return columns_end_of(word) != END_NONE
               ? pose_list_add(ends, &row, name.text, NULL)
               : fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\", wanted is entry or target, as above", number,
                      POSE_QUOTE(word));
}

/* Each name has an entry and a target, and they are not the same place in two spaces. */
static conus_status check_pairs(const conus_pose_list *ends, double longest)
{
    size_t near = 0;
    for (size_t i = 0; i < ends->count; i += 2) {
        const conus_pose_row *end = &ends->rows[i];
        double way[3];
        bool fits = i + 1 < ends->count && strcmp(end[0].id, end[1].id) == 0 && !end[0].trigger && end[1].trigger;
        fits = fits && (i + 2 == ends->count || strcmp(end[1].id, end[2].id) != 0);
        if (!fits) {
            return fail(CONUS_ERROR_DATA,
                        "line %zu: \"%.60s\" has not one entry and one target: rows of an axis have one name, and no "
                        "other axis has it",
                        end->line, end->id);
        }
        vec3_sub(way, end[1].pose.world_from_device + 12, end[0].pose.world_from_device + 12);
        near += vec3_length(way) < longest / 20;
    }
    return !ends->count || 4 * near < ends->count ? CONUS_OK : columns_refuse_short(near, ends->count / 2, longest);
}

conus_status pairs_parse(conus_pose_list *list, const struct columns *columns, struct text text,
                         const conus_pose_options *options)
{
    conus_pose_list ends = {0};
    struct text line;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        status = add_line(&ends, list, columns, line, number, options);
    }
    order_sort(ends.rows, ends.count, sizeof *ends.rows, compare_names);
    status = status ? status : check_pairs(&ends, options->longest);
    order_sort(ends.rows, status ? 0 : ends.count / 2, 2 * sizeof *ends.rows, compare_lines);
    for (size_t i = 0; !status && i < ends.count; i += 2) {
        const conus_pose_row *end = &ends.rows[i];
        conus_pose_row row = pose_row_at(end->line);
        conus_status bad =
            pose_row_toward(&row, end[0].pose.world_from_device + 12, end[1].pose.world_from_device + 12, NULL);
        row.range[1] = row.target_mm;
        status = pose_list_add(list, &row, text_from(end->id), bad ? conus_message() : NULL);
    }
    pose_list_finish(&ends);
    return status;
}
