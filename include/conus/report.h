/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file report.h
 * Answers as text: tables, JSON, and what other programs read.
 */
#ifndef CONUS_PUBLIC_REPORT_H
#define CONUS_PUBLIC_REPORT_H

#include <conus/image.h>
#include <conus/plan.h>
#include <conus/pose.h>
#include <conus/selection.h>
#include <conus/study.h>

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_report conus_report; /**< Answers collected for writing. */

/** The order of the answers to a query. */
typedef enum conus_order {
    CONUS_ORDER_RANK = 0, /**< The best score first. */
    CONUS_ORDER_DEPTH /**< The nearest first: by entry with all layers, else, and of a ball, by distance; of equal ones
                         the best. Objects with neither come before unassigned, which is last. */
} conus_order;

/** How a part of a question was understood: a point that was given as words, or else a sentence. */
typedef struct conus_named_place {
    const char *option; /**< What it is for: "toward", "point"; "" = the whole question. */
    const char *text;   /**< The words; of a sentence that. */
    conus_place place;  /**< As which they were understood. */
    bool is_sentence;   /**< There is no place. */
} conus_named_place;

/** What tells answers apart besides their ids, and what is known of their poses: columns of rows and lines for people.
 * The formats of other programs have none of it. */
typedef struct conus_row_marks {
    bool has_number; /**< There is a column `row`. */
    bool has_time;   /**< There is a column `time_s`. */
    const char *const
        *names;      /**< [count] Names of further columns, at the end of a row. No other column is called so. */
    size_t count;    /**< How many; 0 = none. */
    uint64_t number; /**< The value of `row`: number of the pose in its file, from 1. */
    double time_s;   /**< Seconds; NaN = n/a. */
    const char *const *texts; /**< [count] The values of the further columns, of which each may be NULL or "", n/a. */
} conus_row_marks;

/** The content of a report, and how it is written. */
typedef struct conus_report_options {
    size_t struct_size; /**< Its size, as #CONUS_REPORT_OPTIONS_INIT sets it; 0 = that of this version. */
    /** What its rows are of, each with its own columns; a name of conus_list_choices(). "answers", "shares" and
     * "summaries" come from conus_report_add(), "plan" and "constraints" from conus_report_add_plan(), "profile" from
     * conus_report_add_profile(), "tolerance" from conus_report_add_tolerance(), others from tables: "admissions" of
     * conus_sweep(), "chances" of conus_jitter(), "coverages" of conus_overlap(), "clusters", "segments",
     * "connections", "clearances". Of "shares", which have the angle, answers in a row that have one id belong
     * together. Of "summaries" each answer is one row, and "table" is no format. NULL = "answers". */
    const char *rows;
    /** "table" for people, "tsv", "csv" (RFC 4180), "json" (one array), "ndjson" (an object a line); or of another
     * program, of "answers" as a whole (docs/formats.md): "afni", "bids", "spikeglx", "open-ephys", "bep032". A name of
     * conus_list_choices(). NULL = "table". */
    const char *format;
    conus_space space;            /**< Space of the positions written. */
    bool all_voxels;              /**< Voxels of areas are kept, too, not only of pathways. */
    bool no_voxels;               /**< Do not keep any for it: quicker, and less memory. */
    const char *command;          /**< The command line, for the provenance; NULL = none. */
    const conus_tracker *tracker; /**< For a report on its steps, with the columns time_s, selected and confirmed; it
                                     must outlive the report. NULL = none. */
    bool selected_only;       /**< Rows of a step only for the selected and the confirmed object; if there is none, for
                                 unassigned. */
    const char *electrodes;   /**< For "bids": the text of the table; each of its rows is a query, errors
                                 among them. NULL = none. */
    const char *atlas;        /**< Value of a column `atlas`, behind `query`, in each row; not in formats of other
                                 programs. NULL = there is no such column. */
    const conus_frame *frame; /**< Frame of the positions written, instead of @p space; copied. NULL = @p space, which
                                 then is #CONUS_SPACE_RAS or #CONUS_SPACE_LPS. */
    conus_order order;        /**< For "answers" in the formats up to "ndjson", not of a track. */
    conus_contacts contacts;  /**< For "open-ephys", of shanks: tables of conus_segments(). */
    double within; /**< For "clearances": that of conus_clearance(), which a batch calls with it; mm, 0 = only
                      what the needle meets, INFINITY = all objects. */
    const conus_probe *probe; /**< For "answers" and "summaries": each query is a contact of these,
                                 in their order, with the columns probe, shank_id and channel; "bep032"
                                 needs it. It must outlive the report. NULL = none. */
    bool placed;              /**< For "bep032": x, y and z are positions in @p space or @p frame, not those on the
                                 probe. */
    bool points;              /**< For "answers" and "summaries": columns x, y and z with the point,
                                 or the apex, that was asked. */
    bool radii; /**< With @p points: a column radius_mm with the radius of the ball, 0 of a point alone. */
    const conus_named_place *places; /**< [place_count] How the question was understood: the first lines of a table for
                                        people; points are "Places" of JSON and sidecar, sentences "Understood". They
                                        must outlive the report. */
    size_t place_count;              /**< How many there are. */
    const conus_row_marks *marks; /**< Columns that tell rows apart, not of a track. It must outlive the report. Before
                                     an answer is added, the caller sets its last three members, which are copied; a
                                     batch sets them itself. NULL = none. */
    double roll;                  /**< Of a batch with a probe: as for conus_probe_place(), degrees. */
    double depth; /**< Of a batch with a probe: how far the tip lies from a pose along its axis, mm; a pose with a range
                     of its own has the tip at its far end. */
} conus_report_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_REPORT_OPTIONS_INIT CONUS_INIT_(conus_report_options)

/** Starts a report on answers of a selector.
 * @param[out] out The report; end it with conus_report_destroy().
 * @param selector Must outlive the report. NULL for rows that are of no atlas.
 * @param options NULL = defaults. Its strings must outlive the report.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for options that do not go together. */
CONUS_CHECKED conus_status conus_report_create(conus_report **out, const conus_selector *selector,
                                               const conus_report_options *options);

/** Adds one answer.
 * @param report The report.
 * @param query_id Copied, as UTF-8 without control characters.
 * @param selection The answer; may end afterwards.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT in a report of other rows. */
CONUS_CHECKED conus_status conus_report_add(conus_report *report, const char *query_id,
                                            const conus_selection *selection);

/** Adds the answer of a study: of conus_sweep(), conus_jitter(), conus_overlap(), conus_clusters(), conus_segments(),
 * conus_clearance() or conus_connectivity(). To "spikeglx" and "open-ephys" segments are a
 * shank, whose tip is at the far end of the selector's range; then all queries are shanks.
 * @param report The report.
 * @param query_id As for conus_report_add().
 * @param table Of the report's selector, with positions in the frame of the report. It may end afterwards.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT in a report of other rows, of another frame, or within another distance. */
CONUS_CHECKED conus_status conus_report_add_table(conus_report *report, const char *query_id, conus_table *table);

/** Adds the poses that a plan lists.
 * @param report Of "plan", whose columns then are those of the plan's constraints, too, or of
 * "constraints". Nothing else is added to it.
 * @param plan Of the report's selector; must outlive the last text of @p report.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT in a report of other rows, and for a second plan. */
CONUS_CHECKED conus_status conus_report_add_plan(conus_report *report, conus_plan *plan);

/** Adds the distances of the axes that a plan lists from the structures to be avoided, from their near to their far
 * ends: a row for each depth, the last one at the far end, and each structure that is avoided by clearance.
 * @param report Of "profile". Nothing else is added to it.
 * @param plan As for conus_report_add_plan().
 * @param step mm from depth to depth, more than 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT in a report of other rows, for a second plan, and for a step that is out of
 * range or gives a needle more than 100000 depths. */
CONUS_CHECKED conus_status conus_report_add_profile(conus_report *report, conus_plan *plan, double step);

/** Adds how far the poses that a plan lists may be off: a row for each side of each degree of freedom, and with a box
 * one of all at once (Eq. 23).
 * @param report Of "tolerance". Nothing else is added to it.
 * @param plan As for conus_report_add_plan().
 * @param options Where the pivot is; shifts are along the axes of the report's space, whatever these say. NULL =
 * defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT in a report of other rows, and for a second plan; the errors of
 * conus_select(). */
CONUS_CHECKED conus_status conus_report_add_tolerance(conus_report *report, conus_plan *plan,
                                                      const conus_tolerance_options *options);

/** Adds a query without an answer: one row of kind "error" with "line N: " and @p reason for a name, all else missing.
 * @param report The report.
 * @param query_id As for conus_report_add().
 * @param line The pose's in its file; 0 = it has none, and only the reason is written.
 * @param reason One line. Copied.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_report_add_error(conus_report *report, const char *query_id, size_t line,
                                                  const char *reason);

/** Joins a report on another atlas, which was asked the same: each text of @p report has, for each query (of
 * "shares" for all answers that belong together), its own rows and behind them those of @p more, then those
 * of reports that are joined later. The queries are added to each report, in the same order.
 * @param report The report whose texts are taken from now on.
 * @param more Must outlive the last text of @p report. Its own texts are still its own; it can be joined once.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT unless both have a column `atlas`, each with another name, the same options
 * but level, and both atlases or neither were moved (conus_atlas_move()): rows of moved ones have more columns. */
CONUS_CHECKED conus_status conus_report_join(conus_report *report, conus_report *more);

/** Writes the whole text in the report's format.
 * @param[out] text UTF-8 with a final NUL. Borrowed until the next call on the report.
 * @param[out] size Bytes, without the NUL.
 * @param report The report.
 * @return #CONUS_OK; #CONUS_ERROR_DATA for answers that the format cannot hold; #CONUS_ERROR_ARGUMENT where a joined
 * report has another number of queries. */
CONUS_CHECKED conus_status conus_report_text(const char **text, size_t *size, conus_report *report);

/** Writes the JSON sidecar: columns, units, space, atlas files with SHA-256, settings, version.
 * @param[out] text As of conus_report_text().
 * @param[out] size Bytes, without the NUL.
 * @param report The report.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_report_sidecar(const char **text, size_t *size, conus_report *report);

/** Ends a report.
 * @param report NULL is allowed. */
CONUS_API void conus_report_destroy(conus_report *report);

#ifdef __cplusplus
}
#endif

#endif
