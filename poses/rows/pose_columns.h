/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Fields of tables that are separated by tabs or another mark, by the names of their columns. */
#ifndef CONUS_POSES_ROWS_POSE_COLUMNS_H
#define CONUS_POSES_ROWS_POSE_COLUMNS_H

#include "base/status.h"
#include "base/text.h"

enum { POSE_COLUMNS_MOST = 32 };

/** Which fields of a table the columns are that a reader knows; others are passed over. */
struct pose_columns {
    const char *const *names; /**< [count]; "a|b" is called a or b. */
    size_t count;             /**< At most POSE_COLUMNS_MOST. */
    char separator;           /**< 0 = tab. */
    bool quotes_are_plain;    /**< Quotation marks belong to the field. */
    bool may_end_early;       /**< Rows may lack fields behind the last column that is read. */
    size_t at[POSE_COLUMNS_MOST];
    size_t field_count;
};

/** Looks for the columns in the line @p header: CONUS_ERROR_DATA for one that is there twice. */
conus_status pose_columns_find(struct pose_columns *columns, struct text header);

/** Whether the table has this column. */
bool pose_columns_has(const struct pose_columns *columns, size_t column);

/** The fields of a row, [count]; those of columns that the table lacks are empty. CONUS_ERROR_DATA where there are more
 * or (see may_end_early) fewer fields than in the header, or a quotation mark is not closed. */
conus_status pose_columns_split(struct text *fields, const struct pose_columns *columns, struct text line);

/** Whether a field holds no value: empty, "n/a", "None". */
bool pose_field_is_absent(struct text field);

/** The number of @p column. */
conus_status pose_columns_number(double *out, const struct pose_columns *columns, const struct text *fields,
                                 size_t column);

/** Three numbers, times @p scale, of the columns from @p first. */
conus_status pose_columns_point(double out[3], const struct pose_columns *columns, const struct text *fields,
                                size_t first, double scale);

#endif
