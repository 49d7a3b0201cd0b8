/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds columns by their names, and cells by their columns. */
#include "poses/rows/named_cells.h"

#include "poses/rows/pose_row.h"

#include <math.h>

static const size_t NO_COLUMN = SIZE_MAX;

conus_status named_cells_find(struct named_cells *cells, struct text header)
{
    conus_status status = CONUS_OK;
    bool fits = table_split(&cells->line, &cells->table, header);
    cells->width = cells->line.count;
    for (size_t i = 0; i < cells->count; i++) {
        cells->at[i] = NO_COLUMN;
        struct text rest = text_from(cells->names[i]);
        bool more = true;
        (void)text_field(&rest, '/', &more, &cells->called[i]);
        for (size_t k = 0; k < cells->width; k++) {
            struct text cell = cells->line.cells[k];
            if (text_is_one_of(cell, cells->names[i], true)) {
                bool twice = cells->at[i] != NO_COLUMN;
                status = twice ? fail(CONUS_ERROR_DATA, "header: a column %.*s twice", POSE_QUOTE(cell)) : status;
                cells->at[i] = k;
                cells->called[i] = cell;
            }
        }
    }
    return fits ? status : fail(CONUS_ERROR_DATA, "header: more than %d columns", TABLE_CELLS);
}

bool named_cells_has(const struct named_cells *cells, size_t column)
{
    return cells->at[column] != NO_COLUMN;
}

conus_status named_cells_split(struct named_cells *cells, struct text text)
{
    struct table_line *line = &cells->line;
    bool fits = table_split(line, &cells->table, text);
    struct text spoilt = line->spoilt; /* a mark in the middle of a text is one of its letters */
    if (spoilt.data && (line->is_unclosed || (spoilt.data > text.data && spoilt.data[-1] == '"'))) {
        return fail(CONUS_ERROR_DATA, "a quotation mark inside a field, or one that is not closed: %.*s",
                    POSE_QUOTE(spoilt));
    }
    fits = fits && (cells->may_be_longer || line->count <= cells->width);
    for (size_t i = 0; i < (cells->needed ? cells->needed : cells->count); i++) {
        fits = fits && (!named_cells_has(cells, i) || cells->at[i] < line->count);
    }
    return fits ? CONUS_OK : fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", line->count, cells->width);
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

conus_status named_cells_numbers(double *out, const struct named_cells *cells, size_t first, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct text cell = named_cell(cells, first + i);
        if (!table_number(&out[i], &cells->table, cell) || !isfinite(out[i])) {
            char name[POSE_QUOTE_LIMIT + 1];
            snprintf(name, sizeof name, "%.*s", POSE_QUOTE(cells->called[first + i]));
            return pose_no_number(name, cell);
        }
    }
    return CONUS_OK;
}
