/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Shared by the tables for people. */
#ifndef CONUS_SELECTION_REPORT_REPORT_TABLE_H
#define CONUS_SELECTION_REPORT_REPORT_TABLE_H

#include "selection/report/report.h"

#define TABLE_NOTHING "(nothing hit)"

enum { TABLE_LABEL_SIZE = 24 };

/** The name of an object for people; TABLE_NOTHING for 0. */
const char *table_name(const conus_report *report, uint32_t object);

/** Its label in decimal, written to @p out; nothing for 0. */
const char *table_label(char out[TABLE_LABEL_SIZE], const conus_report *report, uint32_t object);

enum { TABLE_VOLUME_SIZE = 32 };

/** A volume in mm³, written to @p out: with one digit behind the point, below 0.1 with three that count. */
const char *table_volume(char out[TABLE_VOLUME_SIZE], double volume);

enum { TABLE_SHARE_SIZE = 16 };

/** A share of the rays in per cent, written to @p out with the digits that @p resolution rays along a side bear: one
 * behind the point from 32 on, none below; "<0.1" or "<1" of what would be 0 but is not. */
const char *table_share(char out[TABLE_SHARE_SIZE], double share, uint32_t resolution);

/** A number of a row of a table: NaN where it is n/a. */
double report_number(const struct report_row *row, const char *column);

/** A text of it: "" where it is n/a. */
const char *report_text(const struct report_row *row, const char *column);

/** Columns for the longest name in the report and in those joined with it, up to a limit. */
int table_name_width(const conus_report *report);

/** @p width, or columns for @p name where that needs more, up to the limit. */
int table_wider(int width, const char *name);

/** Writes @p name, cut or padded with spaces to @p width columns. */
void table_write_name(struct buffer *out, const char *name, int width);

enum { TABLE_AXES_SIZE = 96 };

/** "contact x, y, z": @p what and the axes of the report's space, written to @p out. */
const char *table_axes(char out[TABLE_AXES_SIZE], const conus_report *report, const char *what);

/** Digits behind the point of a coordinate: as many as a voxel is worth. */
int table_digits(const conus_report *report);

/** Writes the line that says where the cone of a query is. */
void table_write_query(struct buffer *out, const conus_report *report, const struct report_query *query);

/** Writes " from (x, y, z) along (x, y, z)": a query's apex and axis in the report's space. */
void table_write_axis(struct buffer *out, const conus_report *report, const struct report_query *query);

/** Writes ", RAS mm" or ", AP, DV, ML um in CCF", and ends the line. */
void table_write_space(struct buffer *out, const conus_report *report);

/** Writes the line above the answers of one of several atlases; nothing where there is one. */
void table_write_atlas(struct buffer *out, const conus_report *report);

/** Writes the line that says what the region of a query is. */
void table_write_region(struct buffer *out, const struct report_query *query);
/** Writes "query NAME: ", with what marks it: "query NAME (row 3, 0.5 s): ". */
void table_write_id(struct buffer *out, const conus_report *report, const struct report_query *query);

/** Writes the line of a query without an answer. */
void table_write_error(struct buffer *out, const conus_report *report, const struct report_query *query, bool more);

/** Writes the lines that say what the answers rest on, of all reports that are joined. */
void table_write_sources(struct buffer *out, const conus_report *report);

#endif
