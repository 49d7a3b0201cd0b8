/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The cells of a program's table by the exact names of its columns, where columns.h need not guess. */
#ifndef CONUS_POSES_ROWS_NAMED_CELLS_H
#define CONUS_POSES_ROWS_NAMED_CELLS_H

#include "base/formats/table.h"
#include "base/job/job.h"

enum { NAMED_CELLS_MOST = 32 };

/** Which cells of a table a reader wants; others are passed over. */
struct named_cells {
    const char *const *names; /**< [count]; "a/b" is called a or b. */
    size_t count;             /**< At most NAMED_CELLS_MOST. */
    struct table table;       /**< What stands between cells. */
    size_t needed;            /**< Each row has cells of the first of them; 0: of all. */
    bool may_be_longer;       /**< Rows may have more cells than the header. */
    size_t at[NAMED_CELLS_MOST];
    struct text called[NAMED_CELLS_MOST]; /**< What the header has; borrowed. */
    size_t width;                         /**< Cells of the header. */
    struct table_line line;               /**< The row. */
};

/** Looks for the columns in the line @p header, which must live as long. One that is there twice is an error; @p job
 * NULL: it is not asked. */
void named_cells_find(struct job *job, struct named_cells *cells, struct text header);

/** Whether the table has this column. */
bool named_cells_has(const struct named_cells *cells, size_t column);

/** Takes a row to pieces, until the next one. An error where a cell that is needed is missing, where there are more
 * than in the header, or a quotation mark is not closed. */
void named_cells_split(struct job *job, struct named_cells *cells, struct text line);

/** The row's cell of @p column; empty where the table lacks it. */
struct text named_cell(const struct named_cells *cells, size_t column);

/** Whether it holds no value: empty, "n/a", "None", "(null)". */
bool named_cell_is_absent(const struct named_cells *cells, size_t column);

/** The numbers of @p count columns from @p first. */
void named_cells_numbers(struct job *job, double *out, const struct named_cells *cells, size_t first, size_t count);

#endif
