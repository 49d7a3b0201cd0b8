/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes an axis of two rows. */
#include "poses/rows/pairs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"

#include <string.h>

/* A row. */
struct end {
    char *name; /* owned */
    double point[3];
    size_t line;
    bool is_target;
};

struct ends {
    struct end *at;
    size_t count, capacity;
};

static int compare_names(const void *left, const void *right)
{
    const struct end *a = left;
    const struct end *b = right;
    int order = strcmp(a->name, b->name);
    return order ? order : (a->is_target > b->is_target) - (a->is_target < b->is_target);
}

/* Pairs of two, by the entry. */
static int compare_lines(const void *left, const void *right)
{
    return compare_unsigned(((const struct end *)left)->line, ((const struct end *)right)->line);
}

/* The row that a line is; one with an error goes to the list at once. */
static conus_status add_line(struct ends *ends, conus_pose_list *list, const struct columns *columns, struct text line,
                             size_t number, const conus_pose_options *options)
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
    enum columns_end which = columns_end_of(word);
    if (which == END_NONE) {
        return fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\", wanted is entry or target, as above", number,
                    POSE_QUOTE(word));
    }
    if (!memory_reserve(&ends->at, &ends->capacity, ends->count + 1, sizeof *ends->at)) {
        return CONUS_ERROR_MEMORY;
    }
    struct end end = {.name = memory_text(name.text.data, name.text.size), .line = number};
    end.is_target = which == END_TARGET;
    memcpy(end.point, row.pose.world_from_device + 12, sizeof end.point);
    if (end.name) {
        ends->at[ends->count++] = end;
    }
    return end.name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Each name has an entry and a target, and they are not the same place in two spaces. */
static conus_status check_pairs(const struct ends *ends, double longest)
{
    size_t near = 0;
    for (size_t i = 0; i < ends->count; i += 2) {
        const struct end *end = &ends->at[i];
        double way[3];
        bool fits =
            i + 1 < ends->count && strcmp(end[0].name, end[1].name) == 0 && !end[0].is_target && end[1].is_target;
        fits = fits && (i + 2 == ends->count || strcmp(end[1].name, end[2].name) != 0);
        if (!fits) {
            return fail(CONUS_ERROR_DATA,
                        "line %zu: \"%.60s\" has not one entry and one target: rows of an axis have one name, and no "
                        "other axis has it",
                        end->line, end->name);
        }
        vec3_sub(way, end[1].point, end[0].point);
        near += vec3_length(way) < longest / 20;
    }
    return !ends->count || 4 * near < ends->count ? CONUS_OK : columns_refuse_short(near, ends->count / 2, longest);
}

conus_status pairs_parse(conus_pose_list *list, const struct columns *columns, struct text text,
                         const conus_pose_options *options)
{
    struct ends ends = {0};
    struct text line;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        status = add_line(&ends, list, columns, line, number, options);
    }
    order_sort(ends.at, ends.count, sizeof *ends.at, compare_names);
    status = status ? status : check_pairs(&ends, options->longest);
    order_sort(ends.at, status ? 0 : ends.count / 2, 2 * sizeof *ends.at, compare_lines);
    for (size_t i = 0; !status && i < ends.count; i += 2) {
        const struct end *end = &ends.at[i];
        conus_pose_row row = pose_row_at(end->line);
        conus_status bad = pose_row_toward(&row, end[0].point, end[1].point, NULL);
        row.range[1] = row.target_mm;
        status = pose_list_add(list, &row, text_from(end->name), bad ? conus_message() : NULL);
    }
    for (size_t i = 0; i < ends.count; i++) {
        memory_free(ends.at[i].name);
    }
    memory_free(ends.at);
    return status;
}
