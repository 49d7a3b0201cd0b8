/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Answers as files and text: the format of an answer and its file, rows beside it, files that show a
 * selection, what conus info says; and results that are read back and compared. */
#ifndef CONUS_CLI_ANSWERS_ANSWERS_H
#define CONUS_CLI_ANSWERS_ANSWERS_H

#include "conus/image.h"
#include "conus/own.h"
#include "conus/plan.h"
#include "conus/report.h"
#include "conus/streamlines.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/settings.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* The options for the format of an answer, the file it goes to, and the sidecar beside that file. */

struct answer_settings {
    size_t format; /* of conus_format_at() */
    const char *output;
    const char *sidecar; /* NULL = beside the output */
    bool force;
};

extern const struct option format_options[];        /**< answer_settings: --format */
extern const struct option query_format_options[];  /**< The same, with the formats of other programs. */
extern const struct option answer_output_options[]; /**< answer_settings: --output, --sidecar, --force */

/** The format of --format if that was given, else the one of the ending of --output; a table for stdout, a device or a
 * pipe, which have no ending. False, after an error message, for a file whose ending says nothing. */
bool answer_format(const char **out, const struct arguments *arguments, const struct answer_settings *settings);

/** Finds the path of the sidecar: that of --sidecar; else that of --output with ".json" in place of ".tsv" or ".csv",
 * or behind it. *out is the caller's to free(). It is NULL where no sidecar is written: a report in JSON says
 * everything itself, and --sidecar may be none. Returns the exit code and prints an error unless it is 0. */
int answer_sidecar(char **out, const char *format, const struct answer_settings *settings);

/** Whether nothing is at the @p path, NULL or where the sidecar of a file would be: with --sidecar none, what is there
 * would seem to describe that file. Likewise. */
int answer_check_no_sidecar(const char *path);

/** Checks the names of the atlases' files and the words of the command line, where they are recorded: in a sidecar or
 * a file in JSON. Likewise. */
int answer_check_names(const char *format, const struct outputs *outputs, const struct arguments *arguments,
                       const struct atlases *atlases);

/* Files that show one selection: --image, --mask with its sidecar, --streamlines-out. */

struct selection_file_settings {
    const char *image;
    const char *mask;
    size_t mask_content; /**< conus_grid_content, if given. */
    const char *mask_object;
    const char *streamlines;
};

extern const struct option selection_file_options[];

/** The selection's data that its files need, until they are written. Zeroed: nothing. */
struct selection_files {
    const struct selection_file_settings *settings;
    conus_image *image;
    conus_grid_content mask_content;
    conus_grid *mask;
    char *mask_sidecar; /**< Path; NULL without a mask. */
    conus_streamline_list *streamlines;
};

/* Those that return an int give the exit code and print an error unless it is 0. */

/** Finds the mask's content and its sidecar, which is added to @p outputs. @p out is the caller's to
 * selection_files_finish() in any case. */
int selection_files_init(struct selection_files *out, struct outputs *outputs,
                         const struct selection_file_settings *settings, const struct arguments *arguments);
void selection_files_finish(struct selection_files *files);

/** Takes what the files need. */
int selection_files_take(struct selection_files *files, const conus_selection *selection, const conus_atlas *atlas);

/** Writes them; the mask's sidecar has the SHA-256 of the mask and the inputs of @p provenance. */
int selection_files_write(const struct selection_files *files, conus_report *report,
                          const struct provenance *provenance);

/* Rows beside an answer, or in its place: a table of all options that name a file of them (rows_kinds), and their
 * files. --connectivity is one: which areas the streamlines connect, as a table of areas. */

/** What rows are about; each kind takes what it needs. */
struct asked {
    size_t line;                      /**< Of the file of poses; 0 = none. */
    const conus_pose *pose;           /**< NULL = a point or a region, without an axis. */
    const conus_selection *selection; /**< NULL = all streamlines. */
    double radius;                    /**< The library's, of the ends of streamlines, */
    bool pairs;                       /**< and whether a table of areas is made of them. */
    const conus_roi *roi;
    conus_plan *plan;
    double step;                   /**< mm, of --profile */
    conus_tolerance_options pivot; /**< of --tolerance */
    const conus_together *together;
    double *lead;      /**< mm from the beginning of an axis to its first object, where rows of segments say so. */
    conus_table *made; /**< A table that is there already; the files end it. NULL = none. */
    const char *made_of;
};

struct rows_file;

/** An option that names a file of rows. */
struct rows_kind {
    const char *option;
    const char *rows;   /**< conus_report_options.rows, also in the sidecar's question, */
    const char *region; /**< and what that is about; NULL = what the answer is about. */
    bool needs_file;    /**< It is never in the place of the answer on stdout. */
    bool is_matrix;     /**< Areas by areas, without a sidecar; the first answer alone. */
    /** Makes its table; or adds to the report what is no table yet. */
    conus_status (*study)(conus_table **out, conus_selector *selector, const struct rows_file *file,
                          const struct asked *asked);
    conus_status (*add)(conus_report *report, const struct asked *asked);
};

enum { ROWS_KINDS = 9 };
extern const struct rows_kind rows_kinds[ROWS_KINDS];

struct rows_file {
    const struct rows_kind *kind;
    const char *path;
    double within; /**< Clearances up to so many mm. */
    const char *format;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    conus_report **reports; /**< [count] That of the first atlas has the rows of all. */
    size_t count;
    const conus_table *matrix; /**< The report has it. */
};

/** The files of rows that a command line names. Zeroed: none. */
struct rows_files {
    struct rows_file items[ROWS_KINDS];
    size_t count;
    bool replace; /**< One of them is on stdout, in the place of the answer, which has no other file. */
};

/* Those that return an int give the exit code and print an error unless it is 0. */

/** Finds the files, formats and sidecars (none where --sidecar says so): the format by the ending; on stdout rows have
 * the answer's @p format, unless @p output names a file for it. @p out is the caller's to rows_files_finish() in any
 * case. */
int rows_files_init(struct rows_files *out, const struct arguments *arguments, const char *output, const char *format);
void rows_files_finish(struct rows_files *files);

/** Makes the reports of the next atlas. @p options has space, command and the atlas's name. */
conus_status rows_files_report(struct rows_files *files, const conus_selector *selector,
                               const conus_report_options *options);

/** Adds what atlas @p index answers about query @p id to each file, or why that has no answer. */
conus_status rows_files_add(struct rows_files *files, size_t index, conus_selector *selector, const char *id,
                            struct asked *asked);

/** Adds a row for each atlas that says why a pose has no answer. */
conus_status rows_files_refuse(struct rows_files *files, const char *id, size_t line, const char *why);

/** Writes of each file the sidecar and then the rows. */
int rows_files_write(const struct rows_files *files, const struct provenance *provenance);

/* Options of the ends of streamlines. */

struct ends_settings {
    const char *endpoints;
    const char *connectivity;
    double radius;
};

extern const struct option endpoints_options[];
extern const struct option connectivity_options[]; /**< --connectivity and --endpoint-radius. */

/** Whether the options fit together; prints an error if not. */
bool ends_check(const struct ends_settings *settings, const struct arguments *arguments);

/** The library's radius that these settings mean. */
double ends_radius_of(const struct ends_settings *settings, const struct arguments *arguments);

/** False with a message where no atlas has a bundle to look at. */
bool ends_check_atlases(const struct atlases *atlases);

/* Tab-separated lines as columns for people. */

enum { ALIGNED_COLUMNS = 16 }; /**< At most. */

/** Calls @p put, which writes a header and lines of @p columns cells with tabs between them, and sets these out in
 * columns. Columns whose only value is "n/a" are left out. right[c]: column c is aligned to the right. False without
 * memory, and where @p put is. */
bool aligned_put(FILE *out, bool put(FILE *out, const void *what), const void *what, size_t columns,
                 const bool right[]);
/** Writes a text of any bytes as one cell; "n/a" if there is none. False without memory. */
bool aligned_put_cell(FILE *out, const char *text);

/* The JSON of `conus info --format json`. */

/** The atlas, a new reference; NULL without memory. @p installed: what its name meant; NULL = it was a path. */
json_t *info_json(const conus_atlas *atlas, const conus_installed *installed);

/** "same", "changed", "not there": by conus_source_state. */
extern const char *const info_source_states[];

/** An installed atlas as a JSON object; NULL without memory. */
json_t *info_json_installed(const conus_installed *atlas);

/** Object @p number of the atlas, likewise. */
json_t *info_json_object(const conus_atlas *atlas, size_t number);

/** A text of any bytes; what is not UTF-8 is taken as ISO-8859-1, as in the library's reports. NULL without memory. */
json_t *info_json_bytes(const char *bytes);

/** Numbers for people: sets those to 0 that are within 1e-7 of the largest of them, or of @p scale if that is larger.
 * That is rounding, as of files with single precision. */
void info_drop_rounding(double *numbers, size_t count, double scale);

/** Prints the line "reaches" for the box with these corners, mm, without digits that are only rounding. */
void info_put_reach(FILE *out, const double low[3], const double high[3]);

/** A paragraph for people, with an empty line before it; nothing of an atlas that is not moved or has no areas. */
void info_place_put(FILE *out, const conus_atlas *atlas);

/** A paragraph for people about each, with an empty line before it. */
void info_tracts_put(FILE *out, const conus_atlas *atlas);

/* A result of conus read back from its TSV or CSV file, for comparison. */

enum { RESULTS_KEYS = 14 };

struct results {
    char *bytes;        /**< The text that the cells point into. */
    const char **cells; /**< The header's, then each row's, `columns` at a time. */
    size_t columns, rows;
    char separator;                  /**< Tab or comma. */
    const char **keys[RESULTS_KEYS]; /**< Header cells of query, kind and the others of results_find(); NULL = none. */
    size_t *order;                   /**< Rows, sorted by their keys. */
};

/** Reads @p path, of at most @p limit bytes. Returns the exit code and prints an error unless it is 0; @p out is then
 * the caller's to results_finish(). Two rows with one key are an error. */
int results_load(struct results *out, const char *path, uint64_t limit);
/** The same from @p size bytes at @p bytes, which are copied; @p path is for messages. */
int results_parse(struct results *out, const char *path, const char *bytes, size_t size);
void results_finish(struct results *results);

const char *results_cell(const struct results *results, size_t row, size_t column);

/** Index of the column @p name; false if there is none. */
bool results_column(const struct results *results, const char *name, size_t *column);

/** Finds the row of @p results with the key of @p row of @p other; false if there is none. The key is the query, kind
 * and index, and where a table has them the atlas, the voxel (i, j, k), a segment's order, bundle_index and the areas
 * of a connection. A row that names its atlas never matches one that does not. */
bool results_find(const struct results *results, const struct results *other, size_t row, size_t *found);

/* How two results differ. */

/** A cell, row or column by which two tables differ. */
struct difference {
    const char *what;   /**< "changed" (a cell), "removed" or "added" (a row), "column". */
    size_t line;        /**< From 1, in the first table; of an added row in the second. */
    const char *where;  /**< "query 1: area 3 Core"; of a column "the first" or "the second", which alone has it. */
    const char *column; /**< NULL of a row. */
    const char *before, *after; /**< The cell; else NULL. */
};
typedef void difference_taker(void *user, const struct difference *difference);

struct differences {
    size_t same, changed, removed, added; /**< Rows. */
    size_t columns;                       /**< That are in one of them only. */
};

/** Compares two tables, whose rows belong together by their keys, and calls @p take for each difference. */
void tables_compare(struct differences *out, const struct results *a, const struct results *b, double tolerance,
                    difference_taker *take, void *user);

/** Writes how two pictures differ, in a line. Gives EXIT_DONE for the same picture, EXIT_DIFFERENT for another, and
 * prints an error for all other codes. */
int pictures_compare(FILE *out, const char *a, const char *b, double tolerance);

#endif
