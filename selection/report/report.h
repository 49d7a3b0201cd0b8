/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reports: answers, sweeps and chances collected for writing, and the tables of their columns. */
#ifndef CONUS_SELECTION_REPORT_REPORT_H
#define CONUS_SELECTION_REPORT_REPORT_H

#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"
#include "selection/connectivity/connectivity.h"
#include "selection/selection.h"
#include "selection/study/study.h"
#include "selection/table/table.h"
#include "selection/weight/weight.h"

#include <string.h>

/* Reports: answers, sweeps and chances collected for writing. */

/** What rows are of, and conus_report_options.rows for it. Those from the pairs on have no queries. */
#define REPORT_ROWS(ROW)                                                                                               \
    ROW(ANSWERS, "answers"), ROW(SHARES, "shares"), ROW(ADMISSIONS, "admissions"), ROW(CHANCES, "chances"),            \
        ROW(SUMMARIES, "summaries"), ROW(COVERAGES, "coverages"), ROW(SEGMENTS, "segments"),                           \
        ROW(CONNECTIONS, "connections"), ROW(CLEARANCES, "clearances"), ROW(PLAN, "plan"),                             \
        ROW(CONSTRAINTS, "constraints"), ROW(PROFILE, "profile"), ROW(TOLERANCE, "tolerance"),                         \
        ROW(CLUSTERS, "clusters"), ROW(NEEDLES, "needles"), ROW(PAIRS, "pairs"), ROW(CALIBRATION, "calibration"),      \
        ROW(RELIABILITY, "reliability"), ROW(POSITIONS, "positions")
#define REPORT_ROWS_NUMBER(name, word) ROWS_##name
enum report_rows { REPORT_ROWS(REPORT_ROWS_NUMBER) };

/** Finds them by their word, NULL = answers. */
conus_status report_rows_find(enum report_rows *out, const char *word);

/** Of a format: another program reads it, it is one string of a whole probe, batches write it, it has columns. */
enum format_facts { FOREIGN = 1, OF_PROBE = 2, OF_BATCH = 4, IN_COLUMNS = 8 };

/** All formats: ROW(NUMBER, NAME, WORD, FACTS). A new one is a row here, and a file that defines its
 * report_format_NAME. */
#define REPORT_FORMATS(ROW)                                                                                            \
    ROW(TABLE, table, "table", IN_COLUMNS)                                                                             \
    ROW(TSV, tsv, "tsv", OF_BATCH | IN_COLUMNS)                                                                        \
    ROW(CSV, csv, "csv", OF_BATCH | IN_COLUMNS)                                                                        \
    ROW(JSON, json, "json", IN_COLUMNS)                                                                                \
    ROW(NDJSON, ndjson, "ndjson", OF_BATCH | IN_COLUMNS)                                                               \
    ROW(AFNI, afni, "afni", FOREIGN | OF_BATCH)                                                                        \
    ROW(BIDS, bids, "bids", FOREIGN | OF_BATCH | IN_COLUMNS)                                                           \
    ROW(SPIKEGLX, spikeglx, "spikeglx", FOREIGN | OF_PROBE | OF_BATCH)                                                 \
    ROW(OPEN_EPHYS, open_ephys, "open-ephys", FOREIGN | OF_PROBE | OF_BATCH)                                           \
    ROW(BEP032, bep032, "bep032", FOREIGN | IN_COLUMNS)
#define REPORT_FORMAT_NUMBER(number, name, word, facts) REPORT_##number,
enum report_number { REPORT_FORMATS(REPORT_FORMAT_NUMBER) };

/** Finds one by its word, NULL = the table for people. */
conus_status report_format_find(enum report_number *out, const char *word);

/** A listed pose of a plan; in other rows one of its constraints, perhaps at a depth. */
struct report_planned {
    conus_kind kind; /**< Kind and object begin every row; this one has none. */
    uint32_t object;
    size_t constraint;         /**< Index in the plan. */
    size_t needle;             /**< Index of the needle, of several together, */
    size_t question;           /**< of the question that it answers, */
    size_t combination;        /**< and of its combination. */
    const conus_planned *pose; /**< The plan's. */
    uint64_t order;            /**< Number of the depth, from 1. */
    double depth, distance;    /**< mm from the apex; of the axis there from the structure. */
    double at[3];              /**< The far end, or the point of the axis at the depth; world. */
    double axis[3];            /**< Direction in the report's space. */
    conus_tolerance tolerance; /**< Tolerance of one side of a degree of freedom. */
};

/** A constraint of a plan. */
struct report_constraint {
    const conus_constraint *asked;
    const char *kind, *measure; /**< Words; the latter is NULL of constraints without one. */
    const char *name;           /**< Name of its structure, or NULL. */
    uint64_t index;             /**< From 1 among those of its kind. */
    uint64_t left;              /**< How many candidates hold it and those before it. */
    const conus_planned *miss;  /**< The pose that breaks only this constraint; NULL = none. */
    const char *words;          /**< The constraint in words. */
};

/** A plan, with the columns of its constraints. */
struct report_plan {
    struct report_constraint *constraints; /**< [count] */
    size_t count;
    uint64_t candidates, rejected;
    const conus_jitter_options *jitter; /**< NULL = none. */
    struct report_column *columns;      /**< [column_count] */
    size_t column_count;
    struct buffer words; /**< All texts that are made for them. */
};

/** A question of several needles together. */
struct report_question {
    const conus_answered *answered;
    struct report_plan plan;
    size_t *places; /**< [report_needles.column_count] Index of the column in the plan's; SIZE_MAX = it has none. */
};

/** Several needles together, with the columns that some of them have. */
struct report_needles {
    struct report_question *questions; /**< [question_count] */
    size_t question_count;
    const conus_placed **at; /**< [count] */
    size_t count;
    const conus_combination **combinations; /**< [combination_count] */
    size_t combination_count;
    const conus_together_options *asked;
    const conus_conflict *conflict; /**< NULL = there is none. */
    struct report_column *columns;  /**< [column_count] Their offset is their index. */
    size_t column_count;
};

/** Whether a constraint is a distance to be kept. */
static inline bool report_is_clearance(const struct report_constraint *constraint)
{
    return constraint->asked->kind == CONUS_CONSTRAINT_AVOID && constraint->asked->measure == CONUS_MEASURE_LENGTH;
}

/** A row of a table. */
struct report_table_row {
    conus_kind kind;
    uint32_t object;
    const conus_table *table;
    size_t index;
};

/** One result of one query. conus_report.kind says which member it has; kind and object begin all of them. */
struct report_row {
    size_t query; /**< Index into conus_report.queries. */
    union {
        conus_result result;
        struct report_table_row of_table;
        struct report_planned planned;
    };
};

struct report_query {
    char *id;        /**< UTF-8 without control characters.                     */
    uint64_t number; /**< Of options.marks, */
    double time_s;
    char **kept;                        /**< [options.marks->count] and its texts, owned; NULL = there are none. */
    const conus_probe_contact *contact; /**< Of the report's probes; NULL = there is none. */
    const char *probe;                  /**< The contact's probe, where it is not called as in its file; else NULL. */
    char *error;                        /**< Why there is no answer, likewise; NULL if there is one. */
    conus_table *table;                 /**< Of rows of tables: held; NULL of another. */
    struct table_question asked;        /**< Its region's path is the table's. */
    uint32_t cone_pixels;               /**< Pixels of the aperture.                              */
    bool is_point;                      /**< The ball only stands for its centre. */
    conus_step step;                    /**< In a report on a track. */
    size_t first_row;
    size_t first_voxel; /**< Where in conus_report.voxels its rows begin. */
};

struct conus_report {
    const conus_atlas *atlas;
    const char **prefixes; /**< Of conus_atlas_prefixes(), for tables for people; else NULL. */
    char *name;            /**< The value of the column `atlas`; NULL = there is none. */
    conus_report *next;    /**< Joined: its rows come behind these, query by query. NULL = none. */
    bool is_joined;        /**< Another report has it as its next. */
    conus_selector_options selector;
    struct weight_facts weight;           /**< form is NULL of a selector without one. */
    struct prior prior;                   /**< Without its numbers; power is 0 where there is no posterior. */
    char score[FORMULA_LENGTH_LIMIT + 1]; /**< Name or formula of the ranking. */
    char *level;                          /**< NULL = none. */
    uint32_t *level_areas;                /**< The areas of a level given as a list, by number. */
    size_t level_area_count;
    char engine[96];
    conus_report_options options; /* its space is that of the frame */
    enum report_rows kind;
    enum report_number as;
    conus_frame frame;
    struct report_query *queries;
    size_t query_count, query_capacity;
    struct report_row *rows;
    size_t row_count, row_capacity;
    struct report_plan plan;
    struct report_needles needles;
    struct text *electrode_lines; /**< For BIDS: the header without the added columns, then the rows. */
    size_t electrode_line_count, electrode_line_capacity, electrode_field_count;
    struct report_bep032 *bep032; /**< For BEP032; owned. */
    struct report_column *fields; /**< [field_count] Of rows of tables: their columns. */
    size_t field_count;
    struct report_column *kept;         /**< [options.marks->count] The further columns; their names are owned. */
    size_t taken;                       /**< Queries that were handed out before. */
    const conus_probe_contact *contact; /**< A batch's: of the answers added next. NULL = in their order. */
    const char *contact_probe;          /**< What its probe is called. */
    struct buffer voxels;               /**< TSV rows of conus_report_voxels(), without its header. */
    struct buffer text;                 /**< The text that was last handed out. */
    bool is_begun;                      /**< conus_report_take() has given the header row. */
};

/** Adds a copy of @p query, with the id @p id, and @p count rows, which the caller fills from *rows on. */
conus_status report_append(struct report_row **rows, conus_report *report, const char *id,
                           const struct report_query *query, size_t count);

/** Whether positions are those of somebody's own scalp, whose errors are not known. */
static inline bool report_is_of_scalp(const conus_table *positions)
{
    return conus_table_rows(positions) && isnan(conus_table_numbers(positions, "error_mm")[0]);
}

/** Whether its rows are of an atlas. */
bool report_has_atlas(const conus_report *report);

/** Whether its rows are all there is, not answers to queries. */
static inline bool report_has_no_queries(const conus_report *report)
{
    return report->kind >= ROWS_PAIRS;
}

/** CONUS_ERROR_ARGUMENT for a table of other rows than the report's, or with positions in another frame. */
conus_status report_check_table(const conus_report *report, const conus_table *table);

void report_plan_finish(struct report_plan *plan);
void report_needles_finish(struct report_needles *needles);

/** Drops all queries and rows, and keeps the memory. */
void report_clear(conus_report *report);

/** The plan whose pose a row is about. */
static inline const struct report_plan *report_plan_of(const conus_report *report, const struct report_row *row)
{
    return report->needles.count ? &report->needles.questions[row->planned.question].plan : &report->plan;
}

/** Whether two queries are about one pose. */
static inline bool report_is_same_pose(const conus_report *report, size_t a, size_t b)
{
    const struct report_query *x = &report->queries[a];
    const struct report_query *y = &report->queries[b];
    return x->number == y->number && strcmp(x->id, y->id) == 0;
}

/** Behind the last row of a query. */
static inline size_t report_row_end(const conus_report *report, size_t query)
{
    return query + 1 < report->query_count ? report->queries[query + 1].first_row : report->row_count;
}

/** Whether the text has this row: of summaries and of BEP032 only the first of each query is written. */
static inline bool report_is_shown(const conus_report *report, size_t row)
{
    bool is_one_row = report->kind == ROWS_SUMMARIES || report->as == REPORT_BEP032;
    return !is_one_row || row == 0 || report->rows[row].query != report->rows[row - 1].query;
}

/** The marks whose columns the report has; NULL = none. */
static inline const conus_row_marks *report_marks(const conus_report *report)
{
    return conus_format_at(report->as)->is_foreign ? NULL : report->options.marks;
}

/** Whether rows are about the axis of a device. */
static inline bool report_is_of_axes(enum report_rows rows)
{
    return rows == ROWS_SEGMENTS || rows == ROWS_CLEARANCES;
}

static inline bool report_is_selected(const conus_report *report, const struct report_row *row)
{
    return row->result.object && row->result.object == report->queries[row->query].step.selected;
}

static inline bool report_is_confirmed(const conus_report *report, const struct report_row *row)
{
    return row->result.object && row->result.object == report->queries[row->query].step.confirmed;
}

/* report_text.c */
/** Appends the header row, where the format has one. */
void report_write_header(struct buffer *out, const conus_report *report);

/** Appends the text of the queries that are there, without a header row: of every format but JSON. */
conus_status report_write_part(struct buffer *out, const conus_report *report);

/* The columns of reports: tables that say where each value lies, and the cells that they give. */

/** Where the value of a column lies. */
enum column_home {
    HOME_ROW = 0,     /**< In struct report_row. */
    HOME_QUERY,       /**< In struct report_query. */
    HOME_POSE,        /**< In the conus_planned of the row, */
    HOME_VERDICTS,    /**< in the verdicts of its constraints, */
    HOME_VERDICT,     /**< in that of the row's own, */
    HOME_CONSTRAINT,  /**< in the struct report_constraint of this, */
    HOME_COMBINATION, /**< or in the conus_combination of the row. */
    HOME_CONTACT,     /**< In the contact of the report's probes that the query is about. */
    HOME_MARKS,       /**< In struct report_query, also of one without an answer, */
    HOME_KEPT,        /**< or in its texts that were kept, at this index, likewise. */
    HOME_TABLE,       /**< In the row's table, the column of this index, */
    HOME_NEEDLE       /**< or in the plan of the row's needle, the column that is there. */
};

/** Without one of its needs a cell is n/a. */
enum column_needs {
    NEEDS_RAYS = 1,   /**< The query is a cone: a ball has no pixels and no rays. */
    NEEDS_CENSUS = 2, /**< Voxels were counted: with all layers, or in a ball.    */
    NEEDS_OBJECT = 4, /**< The row is not CONUS_KIND_UNASSIGNED.                       */
    NEEDS_LAYERS = NEEDS_CENSUS | NEEDS_OBJECT,
    NEEDS_BUNDLE = 8 /**< The row is of CONUS_KIND_BUNDLE. */
};

/** Without one of these a report has no such column. */
enum column_only {
    ONLY_LAYERS = 1,    /**< All layers. */
    ONLY_MOVED = 2,     /**< An atlas that was moved. */
    ONLY_WEIGHT = 4,    /**< A weight, */
    ONLY_POSTERIOR = 8, /**< a posterior, */
    ONLY_DOSES = 16,    /**< or a weight, and all layers or points. */
    ONLY_BUNDLES = 32,  /**< Bundles, of this atlas or of one that is joined. */
    ONLY_COVERS = 64,   /**< Several needles, whose contacts are counted, */
    ONLY_ARCS = 128     /**< or which are on arcs. */
};

struct report_column {
    const char *name;
    const char *units; /**< NULL if it has none. */
    const char *description;
    enum column_type type;
    size_t offset; /**< Where the value lies in its home, or its index there. */
    enum column_home home;
    unsigned needs;    /**< enum column_needs */
    unsigned only;     /**< enum column_only */
    bool unless_zeros; /**< Only where some row is not 0. */
    struct cell (*get)(const conus_report *report, const struct report_row *row);
};

enum {
    REPORT_COLUMN_LIMIT = 256, /* more than any kind of report has */
    REPORT_KEPT_LIMIT = 64     /* of these, columns that were kept */
};

/** The columns of a report, one after the other. */
struct report_columns {
    const struct report_column *at[REPORT_COLUMN_LIMIT];
    size_t count;
};

/** The columns of the tables that are rows of this kind; NULL: its rows are none of tables. */
const struct table_fields *report_fields(enum report_rows rows);

void report_list_columns(struct report_columns *out, const conus_report *report);

/** Makes the column of the text number @p index of those that are kept; @p name is borrowed. */
void report_kept_column(struct report_column *out, const char *name, size_t index);

/** Which of enum column_needs a row meets. A column that has others is n/a. */
unsigned report_needs_met(const conus_report *report, const struct report_row *row);

/** The value in a column; n/a in most columns of a query without an answer. */
struct cell report_cell(const conus_report *report, const struct report_column *column, const struct report_row *row);

/** Turns a world point into the report's space. */
void report_point(const conus_report *report, double point[3]);

/** The unit of a column, NULL if it has none: of coordinates that of the report's space. */
const char *report_units(const conus_report *report, const struct report_column *column);

#endif
