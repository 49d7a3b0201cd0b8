/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The writers of all formats. report.c calls them as it collects, report_text.c as it hands out; a writer
 * appends its text to @p out. */
#ifndef CONUS_SELECTION_REPORT_REPORT_WRITERS_H
#define CONUS_SELECTION_REPORT_REPORT_WRITERS_H

#include "selection/report/report_columns.h"

/* report_rows.c: TSV, CSV and NDJSON. */
void report_write_cell(struct buffer *out, struct cell cell);
/** The header row of TSV and CSV. */
void report_write_names(struct buffer *out, const conus_report *report);
void report_write_rows(struct buffer *out, const conus_report *report);
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
conus_status report_write_json(struct buffer *out, const conus_report *report);
conus_status report_write_sidecar(struct buffer *out, const conus_report *report);
conus_status report_write_grid_sidecar(struct buffer *out, const conus_report *report, const conus_grid *grid);

/* report_electrodes.c: BIDS. */
/** Reads the table of options.electrodes, whose rows the queries are. */
conus_status report_read_electrodes(conus_report *report);
void report_write_electrodes_header(struct buffer *out, const conus_report *report);
conus_status report_write_electrodes(struct buffer *out, const conus_report *report);

/* Other programs. */
void report_write_afni(struct buffer *out, const conus_report *report);
conus_status report_write_spikeglx(struct buffer *out, const conus_report *report);
conus_status report_write_open_ephys(struct buffer *out, const conus_report *report);

/** report_voxels.c: Adds the voxels that the rays of @p selection, the report's last query, hit first, or with all
 * layers those with their centre in it, as rows of report->voxels. */
conus_status report_add_voxels(conus_report *report, const conus_selection *selection);

#endif
