/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The columns of reports: tables that say where each value lies, and the cells that they give. */
#ifndef CONUS_SELECTION_REPORT_REPORT_COLUMNS_H
#define CONUS_SELECTION_REPORT_REPORT_COLUMNS_H

#include "selection/report/report.h"
#include "selection/table/cell.h"

/** Where the value of a column lies. */
enum column_home {
    HOME_ROW = 0,  /**< In struct report_row. */
    HOME_QUERY,    /**< In struct report_query. */
    HOME_POSE,     /**< In the conus_planned of the row, */
    HOME_VERDICTS, /**< or in the verdicts of its constraints. */
    HOME_CONTACT,  /**< In the contact of the report's probes that the query is about. */
    HOME_MARKS,    /**< In struct report_query, also of one without an answer, */
    HOME_KEPT,     /**< or in its texts that were kept, at this index, likewise. */
    HOME_TABLE,    /**< In the row's table, the column of this index, */
    HOME_NEEDLE    /**< or in the plan of the row's needle, the column that is there. */
};

/** Without one of its needs a cell is n/a. */
enum column_needs {
    NEEDS_RAYS = 1,   /**< The query is a cone: a ball has no pixels and no rays. */
    NEEDS_CENSUS = 2, /**< Voxels were counted: with all layers, or in a ball.    */
    NEEDS_OBJECT = 4, /**< The row is not CONUS_KIND_UNASSIGNED.                       */
    NEEDS_LAYERS = NEEDS_CENSUS | NEEDS_OBJECT,
    NEEDS_BUNDLE = 8 /**< The row is of CONUS_KIND_BUNDLE. */
};

struct report_column {
    const char *name;
    const char *units; /**< NULL if it has none. */
    const char *description;
    enum column_type type;
    size_t offset; /**< Where the value lies in its home, or its index there. */
    enum column_home home;
    unsigned needs;      /**< enum column_needs */
    bool layers_only;    /**< Only in reports of all layers. */
    bool moved_only;     /**< Only of an atlas that was moved. */
    bool weights_only;   /**< Only with a weight, */
    bool posterior_only; /**< or a posterior. */
    bool bundles_only;   /**< Only where an atlas has bundles. */
    bool unless_zeros;   /**< Only where some row is not 0. */
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
const struct table_fields *report_fields(conus_rows rows);

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
