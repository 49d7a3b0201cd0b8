/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Poses from a table whose header names the columns, from sixteen numbers, and from plain points. */
#ifndef CONUS_POSES_POSE_TABLE_H
#define CONUS_POSES_POSE_TABLE_H

#include "base/text.h"
#include "conus/pose_file.h"
#include "poses/rows/pose_row.h"

enum {
    POSE_COLUMNS = 41,
    POSE_COLUMN_LIMIT = 1000,
    POSE_NAME_SIZE = POSE_ID_LIMIT + 1 /**< A byte more than allowed, to notice longer names. */
};

/** The columns that a table's header names. */
struct pose_table {
    char separator;
    uint8_t of_field[POSE_COLUMN_LIMIT]; /**< Column of each field, POSE_COLUMNS = passed over. */
    size_t field_count;
    bool has[POSE_COLUMNS];
    bool has_times, has_angles, has_ranges, has_ids; /**< Rows may have some. */
};

/** Reads the header, CONUS_ERROR_DATA when a column is missing or twice, or when there is not exactly one way of saying
 * where the device points; the axis of @p options asks for rotations, its space may have none. A note names the columns
 * that are passed over. */
conus_status pose_table_header(struct pose_table *out, struct notes *notes, struct text line,
                               const conus_pose_options *options);

/** A row's name; "" if it gives none. */
struct pose_name {
    struct text text; /**< Inside the line, or here: */
    char own[POSE_NAME_SIZE];
};

/** Reads a row into @p row and @p name. An error is the row's, not the table's. */
conus_status pose_table_row(conus_pose_row *row, struct pose_name *name, const struct pose_table *table,
                            struct text line, const conus_pose_options *options);

/** Whether @p text begins like lines of points: three numbers, and then nothing or a name that is no number. */
bool pose_is_point(struct text line);

/** Reads "x y z" or "x y z name", separated by white space or commas. */
conus_status pose_point_row(conus_pose_row *row, struct pose_name *name, struct text line,
                            const conus_pose_options *options);

/** True when the text is nothing but sixteen numbers: then @p row or its error (in *bad) is the pose they are. */
bool pose_plain_matrix(conus_pose_row *row, conus_status *bad, struct text text, const conus_pose_options *options);

#endif
