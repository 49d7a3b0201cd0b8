/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Answers collected for writing. The columns are one table that every format walks. */
#ifndef CONUS_SELECTION_REPORT_H
#define CONUS_SELECTION_REPORT_H

#include "base/buffer.h"
#include "selection/selection.h"

/** One result of one query. */
struct report_row {
    size_t query; /**< Index into conus_report.queries. */
    conus_result result;
};

struct report_query {
    char *id; /**< UTF-8 without control characters. */
    struct cone cone;
    uint32_t cone_pixels; /**< Pixels of the aperture. */
};

struct conus_report {
    const conus_atlas *atlas;
    conus_selector_options selector;
    const char *score; /**< Name of the ranking; static. */
    char *level;       /**< NULL = none.                  */
    char engine[96];
    conus_report_options options;
    struct report_query *queries;
    size_t query_count, query_capacity;
    struct report_row *rows;
    size_t row_count, row_capacity;
    struct buffer voxels; /**< TSV rows of conus_report_voxels(), without its header. */
    struct buffer text;   /**< What was last handed out. */
};

enum cell_type { CELL_NONE, CELL_TEXT, CELL_INTEGER, CELL_NUMBER };

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

/** "area", "pathway", "unassigned". */
const char *report_kind(conus_kind kind);

/** Turns a world point into the report's space. */
void report_point(const conus_report *report, double point[3]);

/** Adds the voxels that @p selection, the report's last query, met first, as rows of report->voxels. */
conus_status report_add_voxels(conus_report *report, const conus_selection *selection);

/* Formats; each appends the whole text to @p out. */
void report_write_table(struct buffer *out, const conus_report *report);
conus_status report_write_json(struct buffer *out, const conus_report *report);
conus_status report_write_ndjson(struct buffer *out, const conus_report *report);
conus_status report_write_sidecar(struct buffer *out, const conus_report *report);

#endif
