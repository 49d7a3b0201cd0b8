/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Rows beside an answer, or in its place: a table of all options that name a file of them (rows_kinds), and
 * their files. --connectivity is one: which areas the streamlines connect, as a table of areas. */
#ifndef CONUS_CLI_ANSWERS_ENDS_H
#define CONUS_CLI_ANSWERS_ENDS_H

#include "conus/plan.h"
#include "conus/report.h"
#include "options/provenance.h"
#include "settings/atlases.h"
#include "settings/settings.h"

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
    conus_table *made; /**< A table that is there already; the files end it. NULL = none. */
    conus_rows made_of;
};

struct rows_file;

/** An option that names a file of rows. */
struct rows_kind {
    const char *option;
    conus_rows rows;
    const char *word;   /**< Its name in the sidecar's question, */
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
    conus_format format;
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
int rows_files_init(struct rows_files *out, const struct arguments *arguments, const char *output, conus_format format);
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

#endif
