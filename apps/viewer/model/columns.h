/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The answers of the window: the columns of their lists, and the answer in a sentence. */
#ifndef CONUS_VIEWER_MODEL_COLUMNS_H
#define CONUS_VIEWER_MODEL_COLUMNS_H

#include "base/text.h"
#include "viewer/model/viewer.h"

/* The columns of the lists of hits: which are shown, their cells as conus query gives them, the order of rows, and
 * the formats that they are exported in. */

enum result_column_number {
    RESULT_RANK = 0, /**< Zero, so that rows are ordered by it unless told. */
    RESULT_NAME,
    RESULT_ABBREVIATION,
    RESULT_LABEL,
    RESULT_SHARE,
    RESULT_SCORE,
    RESULT_PIXELS,
    RESULT_DISTANCE,
    RESULT_ENTRY, /**< With all layers only, as those from RESULT_PIERCED on. */
    RESULT_EXIT,
    RESULT_PATH,
    RESULT_OFFSET,
    RESULT_X, /**< The contact, in the viewer's space. */
    RESULT_Y,
    RESULT_Z,
    RESULT_CONTACT_VALUE,
    RESULT_PIERCED,
    RESULT_VOLUME,
    RESULT_FRACTION,
    RESULT_MEAN,
    RESULT_MAX,
    RESULT_STREAMLINES, /**< From here on: bundles only. */
    RESULT_LENGTH,
    RESULT_ALONG,
    RESULT_COLUMNS
};

enum { RESULT_TEXT = 64, RESULT_TIP = 512, RESULT_FORMATS = 3 };

/** "TSV", "CSV", "JSON": what a list may be exported as. */
extern const char *const result_formats[RESULT_FORMATS];
/** How the name of such a file ends: ".tsv", ... */
extern const char *const result_endings[RESULT_FORMATS];

/** The name of a column in the tables of conus query, such as "distance_mm". */
const char *result_key(size_t column);
/** The column of that name, or RESULT_COLUMNS. */
size_t result_find(const char *key);
/** The word above it; of coordinates the viewer's axis. */
const char *result_heading(const struct viewer *viewer, size_t column);
/** Its meaning and unit. */
const char *result_meaning(char out[RESULT_TIP], const struct viewer *viewer, size_t column);
/** Whether the column has texts, and not numbers. */
bool result_is_text(size_t column);
/** A text as wide as the column's cells get; "" of texts. */
const char *result_widest(const struct viewer *viewer, size_t column);

/** Whether the column has values for the question as it is asked now. */
bool result_is_offered(const struct viewer *viewer, size_t column);
/** Finds the shown columns, in their order; returns how many there are. */
size_t result_shown(size_t out[RESULT_COLUMNS], const struct viewer *viewer);
/** Shows or hides a column; the name is always shown. */
void result_show(struct viewer *viewer, size_t column, bool shown);
/** Shows the columns of these names, and the name; of none the usual ones. False, and no change, if one is unknown. */
bool result_choose(struct viewer *viewer, char *const *keys, size_t count);
/** Orders rows by a column; the second time the other way round; the third time by rank. */
void result_order_by(struct viewer *viewer, size_t column);

/** A cell with the digits of conus query's table for people, "-" where there is nothing; a text whole. The share of
 * what no ray hits first is "behind". */
const char *result_cell(char out[RESULT_TEXT], const struct viewer *viewer, const struct view_atlas *view,
                        size_t column, const conus_result *result);
/** A cell with all digits, as in the TSV of conus query; "n/a" where there is nothing. */
const char *result_exact(char out[RESULT_TEXT], const struct viewer *viewer, const struct view_atlas *view,
                         size_t column, const conus_result *result);

/** The rows of a selection in the viewer's order; to be freed. What has no value comes last, behind
 * all what is unassigned. NULL without memory. */
size_t *result_order(const struct viewer *viewer, const struct view_atlas *view, const conus_selection *selection);

enum { EXPORT_WHY = 256 };

/** Writes what was selected in all atlases to @p path, in the format of its ending, and its sidecar beside it. False:
 * @p why says why not, in one line. */
bool export_results(struct viewer *viewer, const char *path, char why[EXPORT_WHY]);

/* The answer in a sentence of two lines. */

enum { HEADLINE_TEXT = 512 };

struct headline {
    char what[HEADLINE_TEXT]; /**< "Precentral_L", "Caudate_L and Putamen_L", "Reaches Hippocampus_L". */
    char more[HEADLINE_TEXT]; /**< "60 % of the cone \u00b7 50.0 mm from the start \u00b7 left"; " " where there is
                                   nothing to say. */
    bool is_of_plan;          /**< It says what the needle of a plan does, in place of what is hit first. */
};

enum { SHARE_TEXT = TEXT_SHARE_SIZE + 2 };
/** "91 %", with a digit more below 1 and above 99 %: what is not all is not 100 %, and what is not nothing not 0. */
void headline_share(char out[SHARE_TEXT], double share);

/** Words the first tool's answer in the drawn atlas: what the needle of a plan does, wherever that is judged, or else
 * what is hit best: of several whose shares are shown as the same number all, as far as shares decide. */
void headline_find(struct headline *out, struct viewer *viewer);

#endif
