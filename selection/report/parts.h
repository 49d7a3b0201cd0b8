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

/** Of a format: another program reads it, it is one string of a whole probe, batches write it, it has columns. */
enum format_facts { FOREIGN = 1, OF_PROBE = 2, OF_BATCH = 4, IN_COLUMNS = 8 };

/** All formats, in the order of conus_format: ROW(NAME, WORD, FACTS). A new one is a row here, and a file that defines
 * its report_format_NAME. */
#define REPORT_FORMATS(ROW)                                                                                            \
    ROW(table, "table", IN_COLUMNS)                                                                                    \
    ROW(tsv, "tsv", OF_BATCH | IN_COLUMNS)                                                                             \
    ROW(csv, "csv", OF_BATCH | IN_COLUMNS)                                                                             \
    ROW(json, "json", IN_COLUMNS)                                                                                      \
    ROW(ndjson, "ndjson", OF_BATCH | IN_COLUMNS)                                                                       \
    ROW(afni, "afni", FOREIGN | OF_BATCH)                                                                              \
    ROW(bids, "bids", FOREIGN | OF_BATCH | IN_COLUMNS)                                                                 \
    ROW(spikeglx, "spikeglx", FOREIGN | OF_PROBE | OF_BATCH)                                                           \
    ROW(open_ephys, "open-ephys", FOREIGN | OF_PROBE | OF_BATCH)                                                       \
    ROW(bep032, "bep032", FOREIGN | IN_COLUMNS)
#define REPORT_FORMAT_DECLARED(name, word, facts) extern const struct report_format report_format_##name;
REPORT_FORMATS(REPORT_FORMAT_DECLARED)

/** Whether sidecars describe columns of the format. */
bool report_in_columns(conus_format format);

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
