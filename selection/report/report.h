/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Answers collected for writing. The columns are one table that every format walks. */
#ifndef CONUS_SELECTION_REPORT_REPORT_H
#define CONUS_SELECTION_REPORT_REPORT_H

#include "base/buffer.h"
#include "base/text.h"
#include "selection/study/jitter.h"
#include "selection/study/sweep.h"

/** One result of one query: which of them, options.rows says; kind and object begin all of them. */
struct report_row {
    size_t query; /**< Index into conus_report.queries. */
    union {
        conus_result result;
        conus_admission admission;
        conus_chance chance;
    };
};

struct report_query {
    char *id;    /**< UTF-8 without control characters.                     */
    char *error; /**< Why there is no answer, likewise; NULL if there is one. */
    struct cone cone;
    uint32_t cone_pixels;        /**< Pixels of the aperture.                              */
    double ball;                 /**< Radius of a ball around the cone's origin; 0 of a cone. */
    conus_step step;             /**< In a report on a track. */
    conus_jitter_options jitter; /**< Of chances. */
    size_t first_row;
};

struct conus_report {
    const conus_atlas *atlas;
    conus_selector_options selector;
    char score[FORMULA_LENGTH_LIMIT + 1]; /**< Name or formula of the ranking. */
    char *level;                          /**< NULL = none. */
    uint32_t *level_areas;                /**< Of a list, by number. */
    size_t level_area_count;
    char engine[96];
    conus_report_options options;
    struct report_query *queries;
    size_t query_count, query_capacity;
    struct report_row *rows;
    size_t row_count, row_capacity;
    struct text *electrode_lines; /**< Of CONUS_BIDS: the header without what is added, then the rows. */
    size_t electrode_line_count, electrode_line_capacity, electrode_field_count;
    size_t taken;         /**< Queries that were handed out before. */
    struct buffer voxels; /**< TSV rows of conus_report_voxels(), without its header. */
    struct buffer text;   /**< What was last handed out. */
    bool is_begun;        /**< conus_report_take() has given the heading. */
};

enum cell_type { CELL_NONE, CELL_TEXT, CELL_INTEGER, CELL_NUMBER, CELL_TIME };

struct cell {
    enum cell_type type;
    const char *text;
    uint64_t integer;
    double number;
};

struct report_column {
    const char *name;
    const char *units; /**< NULL if it has none. */
    const char *description;
    struct cell (*get)(const conus_report *report, const struct report_row *row);
    bool layers_only; /**< Only in reports of all layers. */
};

/** The column behind @p column in @p report, the first one for NULL; NULL past the last. */
const struct report_column *report_next_column(const conus_report *report, const struct report_column *column);

/** The column called @p name of a report of answers. */
const struct report_column *report_find_column(const char *name);

/** report_next_column() of reports of answers, and of others. */
const struct report_column *report_next_answer_column(const conus_report *report, const struct report_column *column);
const struct report_column *report_next_sweep_column(const conus_report *report, const struct report_column *column);

/** Adds a copy of @p query, with the id @p id, and @p count rows, which the caller fills from *rows on. */
conus_status report_append(struct report_row **rows, conus_report *report, const char *id,
                           const struct report_query *query, size_t count);

const struct report_column *report_next_summary_column(const struct report_column *column);
/** The columns that a table of electrodes gets. */
const struct report_column *report_next_electrode_column(const struct report_column *column);

/** Whether the text has this row: of summaries only the first of each query is written. */
bool report_is_shown(const conus_report *report, size_t row);

/** What stands in a column; n/a in most of a query without an answer. */
struct cell report_cell(const conus_report *report, const struct report_column *column, const struct report_row *row);

void report_write_cell(struct buffer *out, struct cell cell);

/** Drops all queries and rows, and keeps the memory. */
void report_clear(conus_report *report);

/** "area", "pathway", "unassigned". */
const char *report_kind(conus_kind kind);

/** The name of an object for people, cut or padded with spaces to @p width columns. */
void report_write_name(struct buffer *out, const char *name, int width);

static inline bool report_is_selected(const conus_report *report, const struct report_row *row)
{
    return row->result.object && row->result.object == report->queries[row->query].step.selected;
}

static inline bool report_is_confirmed(const conus_report *report, const struct report_row *row)
{
    return row->result.object && row->result.object == report->queries[row->query].step.confirmed;
}

/** Turns a world point into the report's space. */
void report_point(const conus_report *report, double point[3]);

/** Adds the voxels that @p selection, the report's last query, met first, or with all layers those with their centre in
 * it, as rows of report->voxels. */
conus_status report_add_voxels(conus_report *report, const conus_selection *selection);

/** Columns for the longest name in the report, up to a limit. */
int report_name_width(const conus_report *report);
/** The line for people that says where the cone of a query is. */
void report_write_query(struct buffer *out, const conus_report *report, const struct report_query *query);
/** The line of a query without an answer. */
void report_write_error(struct buffer *out, const struct report_query *query, bool more);
/** And those that say what the answers rest on. */
void report_write_sources(struct buffer *out, const conus_report *report);

/** Reads the table of options.electrodes, whose rows the queries are. */
conus_status report_read_electrodes(conus_report *report);

/** What is written of the queries that are there, without a heading: of every format but JSON. */
conus_status report_write_part(struct buffer *out, const conus_report *report);

/* Formats; each appends the whole text to @p out. */
void report_write_table(struct buffer *out, const conus_report *report);
void report_write_track(struct buffer *out, const conus_report *report); /**< The table of a track. */
void report_write_sweep(struct buffer *out, const conus_report *report); /**< The table of what is not answers. */
conus_status report_write_json(struct buffer *out, const conus_report *report);
void report_write_heading(struct buffer *out,
                          const conus_report *report);                  /**< The line of names, where there is one. */
void report_write_rows(struct buffer *out, const conus_report *report); /**< TSV or NDJSON, without that line. */
void report_write_afni(struct buffer *out, const conus_report *report);
void report_write_electrodes_heading(struct buffer *out, const conus_report *report);
conus_status report_write_electrodes(struct buffer *out, const conus_report *report); /**< BIDS, without that line. */
conus_status report_write_spikeglx(struct buffer *out, const conus_report *report);
conus_status report_write_open_ephys(struct buffer *out, const conus_report *report);
conus_status report_write_sidecar(struct buffer *out, const conus_report *report);
conus_status report_write_grid_sidecar(struct buffer *out, const conus_report *report, const conus_grid *grid);

#endif
