/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds columns by their names, and cells by their columns. */
#include "poses/rows/columns.h"

#include "poses/rows/pose_row.h"

#include <math.h>

static const size_t NO_COLUMN = SIZE_MAX;

void named_cells_find(struct job *job, struct named_cells *cells, struct text header)
{
    bool fits = table_split(&cells->line, &cells->table, header);
    if (job && !fits) {
        job_bad(job, "header: more than %d columns", TABLE_CELLS);
    }
    cells->width = cells->line.count;
    for (size_t i = 0; i < cells->count; i++) {
        cells->at[i] = NO_COLUMN;
        struct text rest = text_from(cells->names[i]);
        bool more = true;
        (void)text_field(&rest, '/', &more, &cells->called[i]);
        for (size_t k = 0; k < cells->width; k++) {
            struct text cell = cells->line.cells[k];
            if (text_is_one_of(cell, cells->names[i], true)) {
                if (job && cells->at[i] != NO_COLUMN) {
                    job_bad(job, "header: a column %.*s twice", POSE_QUOTE(cell));
                }
                cells->at[i] = k;
                cells->called[i] = cell;
            }
        }
    }
}

bool named_cells_has(const struct named_cells *cells, size_t column)
{
    return cells->at[column] != NO_COLUMN;
}

void named_cells_split(struct job *job, struct named_cells *cells, struct text text)
{
    struct table_line *line = &cells->line;
    bool fits = table_split(line, &cells->table, text);
    struct text spoilt = line->spoilt; /* a mark in the middle of a text is one of its letters */
    if (spoilt.data && (line->is_unclosed || (spoilt.data > text.data && spoilt.data[-1] == '"'))) {
        job_bad(job, "a quotation mark inside a field, or one that is not closed: %.*s", POSE_QUOTE(spoilt));
    }
    fits = fits && (cells->may_be_longer || line->count <= cells->width);
    for (size_t i = 0; i < (cells->needed ? cells->needed : cells->count); i++) {
        fits = fits && (!named_cells_has(cells, i) || cells->at[i] < line->count);
    }
    if (!fits) {
        job_bad(job, "%zu fields, the header has %zu", line->count, cells->width);
    }
}

struct text named_cell(const struct named_cells *cells, size_t column)
{
    bool has = named_cells_has(cells, column) && cells->at[column] < cells->line.count;
    return has ? cells->line.cells[cells->at[column]] : (struct text){"", 0};
}

bool named_cell_is_absent(const struct named_cells *cells, size_t column)
{
    struct text cell = named_cell(cells, column);
    return !cell.size || text_equal_ignoring_case(cell, "n/a") || text_is_one_of(cell, "None/(null)", true);
}

void named_cells_numbers(struct job *job, double *out, const struct named_cells *cells, size_t first, size_t count)
{
    for (size_t i = 0; i < count && job_ok(job); i++) {
        struct text cell = named_cell(cells, first + i);
        if (!table_number(&out[i], &cells->table, cell) || !isfinite(out[i])) {
            char name[POSE_QUOTE_LIMIT + 1];
            snprintf(name, sizeof name, "%.*s", POSE_QUOTE(cells->called[first + i]));
            (void)JOB_CALL(job, pose_no_number(name, cell));
        }
    }
}
