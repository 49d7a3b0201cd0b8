/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The writers of reports, and what the tables for people share. */
#ifndef CONUS_SELECTION_REPORT_PARTS_H
#define CONUS_SELECTION_REPORT_PARTS_H

#include "selection/report/report.h"

/** The writers of a format, which append to @p out. */
struct report_format {
    void (*header)(struct buffer *out, const conus_report *report); /**< The header row; NULL = there is none. */
    /** The queries that are there, without it. */
    conus_status (*part)(struct buffer *out, const conus_report *report);
    conus_status (*whole)(struct buffer *out, const conus_report *report); /**< In place of both: all there is. */
};
#define REPORT_FORMAT_DECLARED(number, name, word, facts) extern const struct report_format report_format_##name;
REPORT_FORMATS(REPORT_FORMAT_DECLARED)

/** Whether sidecars describe columns of the format. */
bool report_in_columns(enum report_number format);

/* report_rows.c: TSV, CSV and NDJSON. */
void report_write_cell(struct buffer *out, struct cell cell);
/** Which pairs connect areas, area by area. */
struct report_matrix {
    const conus_table *areas, *pairs;
    size_t count;   /**< Of areas. */
    uint32_t *pair; /**< [count count] Its row plus 1; 0: no streamline connects the two. */
};
/** A table of areas, TSV or CSV. */
void report_write_matrix(struct buffer *out, const conus_report *report, const struct report_matrix *matrix);
/** Takes the rows that the text has, query by query (of shares pose by pose), of all reports that are joined. */
typedef void report_take_row(void *user, const conus_report *of, const struct report_row *row);
void report_each_row(const conus_report *report, report_take_row *take, void *user);

/* Tables for people. */
void report_write_table(struct buffer *out, const conus_report *report);    /**< Answers. */
void report_write_track(struct buffer *out, const conus_report *report);    /**< A track. */
void report_write_shares(struct buffer *out, const conus_report *report);   /**< Shares at several angles. */
void report_write_clusters(struct buffer *out, const conus_report *report); /**< Clusters of regions. */
void report_write_plan(struct buffer *out, const conus_report *report);     /**< All rows of plans. */
void report_write_study(struct buffer *out, const conus_report *report);    /**< All other rows of tables. */

/* report_json.c */
conus_status report_write_json_matrix(struct buffer *out, const conus_report *report,
                                      const struct report_matrix *matrix);
conus_status report_write_sidecar(struct buffer *out, const conus_report *report);
conus_status report_write_grid_sidecar(struct buffer *out, const conus_report *report, const conus_grid *grid);

/* report_electrodes.c: BIDS. */
/** Reads the table of options.electrodes, whose rows the queries are. */
conus_status report_read_electrodes(conus_report *report);

/** report_voxels.c: Adds the voxels that the rays of @p selection, the report's last query, hit first, or with all
 * layers those with their centre in it, as rows of report->voxels. */
conus_status report_add_voxels(conus_report *report, const conus_selection *selection);

/* Shared by the tables for people. */

/** How a value of a row is shown. */
enum look {
    LOOK_NAME,        /**< The row's object; `none` where it has none. */
    LOOK_TEXT,        /**< A text; `none` where the column `beside` is n/a. As wide as the longest of those with, or
                         without `beside`. */
    LOOK_LABEL,       /**< The label of the object. */
    LOOK_COUNT,       /**< A count. */
    LOOK_FIXED,       /**< A number with `digits` behind the point. */
    LOOK_PERCENT,     /**< Likewise, a hundred times as much. */
    LOOK_SHORT,       /**< A number with `digits` that count. */
    LOOK_VOLUME,      /**< A volume, by table_volume(). */
    LOOK_SHARE,       /**< A share of the rays, by text_share(). */
    LOOK_STRIKES,     /**< A clearance; where there is none a word by the distance in the column `beside`. */
    LOOK_STREAMLINES, /**< How many of all of the result's streamlines. */
    LOOK_POINT,       /**< Columns `column`x, y and z. */
    LOOK_PLACE        /**< Likewise, between commas. */
};

/** A column of a table for people: what is shown of the row's table, or of its result. */
struct shown {
    const char *title, *unit; /**< Above each other; a unit NULL = that of the space, and its axes beside the title. */
    enum look look;
    int width;          /**< Of texts the least; of names by the report. */
    const char *column; /**< Of the table; NULL: the value is in conus_result, */
    size_t offset;      /**< here, */
    size_t size;        /**< so many bytes. */
    int digits;
    const char *none;  /**< For n/a; NULL = "". */
    const char *after; /**< Each value; NULL = "". */
    const char *beside;
    enum { WITH_ALL, WITH_LAYERS, WITH_WEIGHT, WITH_POSTERIOR, WITH_DOSES, WITH_MEANS, WITH_BUNDLES } with;
    enum { IN_ALL, IN_OBJECTS, IN_BUNDLES } in; /**< The rows that have it; others have spaces there, or end before. */
};

enum { SHOWN_LIMIT = 24 };

/** Columns up to the one without a title, and how wide they are. */
struct layout {
    const struct shown *columns;
    int widths[SHOWN_LIMIT];
};

/** Finds the widths that the rows of all joined reports need. */
struct layout table_lay_out(const conus_report *report, const struct shown *columns);

/** Writes the line of titles, or that of units. */
void table_write_heading(struct buffer *out, const conus_report *report, const struct layout *layout, bool is_unit);

/** Writes a row, without its end of line. */
void table_write_row(struct buffer *out, const conus_report *report, const struct layout *layout,
                     const struct report_row *row);

#define TABLE_NOTHING "(nothing hit)"

enum { TABLE_LABEL_SIZE = 24 };

/** The name of an object for people; TABLE_NOTHING for 0. */
const char *table_name(const conus_report *report, uint32_t object);

/** Its label in decimal, written to @p out; nothing for 0. */
const char *table_label(char out[TABLE_LABEL_SIZE], const conus_report *report, uint32_t object);

enum { TABLE_VOLUME_SIZE = 32 };

/** A volume in mm³, written to @p out: with one digit behind the point, below 0.1 with three that count. */
const char *table_volume(char out[TABLE_VOLUME_SIZE], double volume);

/** Digits behind the point of shares in per cent that the rays of a report bear: one from 32 along a side on. */
int report_share_digits(const conus_report *report);

/** A number of a row of a table: NaN where it is n/a. */
double report_number(const struct report_row *row, const char *column);

/** Columns for the longest name in the report and in those joined with it, up to a limit. */
int table_name_width(const conus_report *report);

/** Columns on a terminal of a UTF-8 text, one per code point (good enough for area names). */
int table_width(const char *text);

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

/* The draft BEP032 of BIDS: what its tables of electrodes and probes say of the contacts of probes. */

/** The version that is written: of the pull request 2307 of the BIDS specification, with 2481 merged into it. */
#define BEP032_DRAFT "draft BEP032 (microelectrode electrophysiology) of 29 July 2026"

/** Finds what is known of the atlas's sides and ids; end it with report_bep032_destroy(). */
conus_status report_bep032_create(struct report_bep032 **out, const conus_atlas *atlas);
void report_bep032_destroy(struct report_bep032 *made);

/** The area that holds the contact of a query, of several the best one; 0 = none does. */
uint32_t report_area(const conus_report *report, size_t query);
/** "L" or "R": what the area's name or the label table says, else by the middle of the atlas; NULL = it is not known.
 */
const char *report_side(const conus_report *report, size_t query);
/** Name and id of an area; NULL for 0, and where none is known. */
const char *report_location(const conus_report *report, uint32_t area);
const char *report_location_id(const conus_report *report, uint32_t area);
/** By what program and atlas areas were found. */
const char *report_localization(const conus_report *report);

/** Appends probes.tsv. */
conus_status report_write_probes(struct buffer *out, const conus_report *report);
/** Appends coordsystem.json. */
conus_status report_write_coordsystem(struct buffer *out, const conus_report *report);

#endif
